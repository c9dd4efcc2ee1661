// The files that say where a run's instruments sit and how well they measure: those that are named, else those that the
// log's own estimator told in PROCESS_INFO.
#pragma once

#include <string>
#include <vector>

#include "common/estimation/smoothing/trial_instruments.hpp"

namespace fathom::runtime {
class CommandLine;
}

namespace fathom::tool {

struct TrialFileOptions {
  std::string config, vehicle, site;
};

/// --config, --vehicle, --site.
void add_trial_files(runtime::CommandLine& command, TrialFileOptions& options);

/// A file that is named takes the place of the log's own of its kind. A note says what the log told.
[[nodiscard]] estimation::TrialFiles trial_files(const TrialFileOptions& options, const Recording& recording,
                                                 std::vector<std::string>& notes);

}  // namespace fathom::tool

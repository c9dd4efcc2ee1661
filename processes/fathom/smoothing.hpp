// A recorded run smoothed, as fathom smooth writes it and fathom regress takes it.
#pragma once

#include <string>
#include <vector>

#include "common/estimation/smoothing/state_reconstruction.hpp"
#include "common/report/smoothed_page.hpp"
#include "common/samples/recording.hpp"
#include "processes/fathom/bus/trial_files.hpp"

namespace fathom::tool {

struct SmoothedRun {
  Recording recording;               ///< with SMOOTHED, without the log's own STATE
  estimation::Reconstruction found;  ///< but for the smoothed states, which stand in `recording`
};

/// As recorded. Where the instruments contradict each other, so that this is refused or refuses more of one than
/// outliers are, once more with what the comparison of sensors corrects: axes, clocks, scales. Says on stderr what it
/// does, how far it is, `notes`, and of which instrument more was refused than outliers are. InputError as
/// estimation::reconstruct_state.
[[nodiscard]] SmoothedRun smoothed_run(Recording recording, const TrialFileOptions& files,
                                       const estimation::ReconstructionOptions& asked, std::vector<std::string> notes);
/// For a page. The filter's states are moved out of `found`.
[[nodiscard]] report::Smoothing smoothing_of(estimation::Reconstruction&& found);

}  // namespace fathom::tool

// From recordings to an answer: sensors are compared, trials reconstructed and divided, and what kinematics has found
// stands beside what forces show. The same for files, for a trial that still goes on, and for other programs.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/model/site.hpp"
#include "common/samples/recording.hpp"
#include "common/verdict/by_likelihood.hpp"

namespace fathom::verdict {

struct Asked {
  std::vector<Recording> recordings;  ///< sorted by time: those to fit first, then those to judge by
  std::size_t fitted{};               ///< so many are fitted; all of them: parts of every run are kept to judge by
  std::vector<std::string> called{};  ///< how people call each, for complaints; empty: by their names
  /// Reads the recordings once more, so that their samples need not be held meanwhile; empty: they are held.
  std::function<std::vector<Recording>()> again{};
};

struct RecordingsSettings {
  inference::Settings inference{};
  learning::Settings learning{};
  const model::Site* site{};  ///< with a map of tags that optical flow is compared with; null: none
};

struct Explained {
  Answer answer;
  std::vector<Trial> fitted;  ///< what was fitted
};

/// What is told goes to `notes`. InputError where a recording cannot be used, beginning with what it is called.
[[nodiscard]] Explained of_recordings(const model::Vehicle& vehicle, Asked asked, const RecordingsSettings& settings,
                                      const Progress& progress, std::vector<std::string>& notes);

/// Faults of sensors that kinematics has found (`result.consistency`) are causes too: they stand before what forces
/// have shown, in the verdict and its causes as well.
void adopt_sensor_faults(Answer& answer);

}  // namespace fathom::verdict

// A recorded run's motion as all of its instruments together tell it: what is known of them, their noises, the process
// noise, the smoother, and whether the result may be believed. What may not is refused: a state that is worse than the
// one in the log is no result.
#pragma once

#include <string>
#include <vector>

#include "common/base/progress.hpp"
#include "common/estimation/smoothing/trial_instruments.hpp"
#include "common/estimation/smoothing/trial_smoother.hpp"

namespace fathom::estimation {

struct ReconstructionOptions {
  bool stated{false};            ///< noises of the settings: nothing from rest, nothing tuned
  bool noises_stated{false};     ///< those of the instruments alone: nothing from rest
  bool without_position{false};  ///< velocity and attitude alone are asked for, position may drift
  bool despite_state{false};     ///< the log's own STATE is known to be the one that is wrong
  bool filtered{true};           ///< the filter's estimates are kept beside the smoother's
  std::optional<KinematicModel> model{};
};

struct Reconstruction {
  KalmanSettings settings;  ///< as they were used
  SmoothedTrial trial;
};

/// Notes go to `notes` as they arise, one line each. InputError in one line when nothing tells the position, when most
/// of an aid's numbers had to be refused, when the result is less sure of the position than any use of it allows, or
/// when it contradicts the log's own valid STATE by far more than both say of themselves.
[[nodiscard]] Reconstruction reconstruct_state(const Recording& recording, const TrialFiles& files,
                                               const ReconstructionOptions& options, std::vector<std::string>& notes,
                                               const Progress& progress = {});

}  // namespace fathom::estimation

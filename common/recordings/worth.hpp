// What stands against fitting anything to a recording, to be said before somebody tries: commands too rare, a craft
// that never moves, thrusters that never change.
#pragma once

#include <string>
#include <vector>

#include "common/samples/recording.hpp"

namespace fathom::recordings {

struct WorthThresholds {
  double command_rate{5.0};      ///< Hz: between slower commands the thrust is not known well enough to explain motion
  double pulse_span{20.0};       ///< us: below, a speed controller stays within its dead band
  double relative_span{0.02};    ///< of the largest force or wrench: below, nothing was commanded
  double rate_spread{0.02};      ///< rad/s, standard deviation: a gyro of a craft at rest scatters less
  double velocity_spread{0.02};  ///< m/s, as of a velocity log at rest
  double position_span{0.10};    ///< m, as of a position at rest
};

/// One sentence each; empty when there is nothing to say.
[[nodiscard]] std::vector<std::string> against_fitting(const Recording& recording,
                                                       const WorthThresholds& thresholds = {});

}  // namespace fathom::recordings

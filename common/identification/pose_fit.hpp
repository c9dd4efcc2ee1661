// The last step of a fit: a model's numbers by every signal, poses too. What a model gets wrong adds up in place and
// heading, so that a position of 5 mm tells four times as much as a velocity of 5 mm/s does. Velocities decide which
// model it is: their windows are short, and a fault of a position cannot mislead them.
#pragma once

#include <optional>
#include <span>

#include "common/identification/trajectory_fit.hpp"

namespace fathom::identification {

struct PoseFitSettings {
  double window{30.0};  ///< s that a trajectory runs from a free beginning
  double block{10.0};   ///< s whose residuals count as one for the covariance
  int threads{2};
};

/// Output error over velocities, rates, places and attitudes, by Gauss-Newton from `by_speeds`, a fit to velocities
/// with its covariance. Each signal weighs by the density of its residual at low frequency, so that one that wanders or
/// is interpolated weighs little. Nothing where no pose is known over a window, where it does not converge, and where a
/// number ends farther from the one by velocities than chance allows (Hausman 1978): poses and velocities then
/// contradict each other; nor where any number would be known a hundred times better than by velocities, which is how a
/// trajectory looks that runs away from all others. Costs and windows stay those of `by_speeds`.
[[nodiscard]] std::optional<FitResult> fit_with_poses(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                                      const PoseFitSettings& settings, const FitResult& by_speeds);

}  // namespace fathom::identification

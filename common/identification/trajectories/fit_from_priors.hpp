// The base model from nothing but the vehicle's file and data: by stages, so that no wrong valley keeps the fit.
#pragma once

#include <span>

#include "common/identification/trajectories/trajectory_fit.hpp"

namespace fathom::identification {

/// Fits the base model from the priors alone: short windows first, then longer ones, then all data. Model::input_hold
/// is the best of straight lines, held, and told afterwards.
[[nodiscard]] FitResult fit_from_priors(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                        const FitSettings& settings);

/// The problem of the first stage: short windows forgive wrong parameters, since there is little time to diverge.
[[nodiscard]] TrajectoryFit shortest_windows(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                             const FitSettings& settings);

/// The stages behind it, each from where the last one ended; the first of them from `start`.
[[nodiscard]] FitResult fit_by_longer_windows(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                              const FitSettings& settings, const model::Model& start);

/// A mass or an inertia that vanishes, or grows out of all proportion, may lie in a wrong valley: velocity follows
/// thrust at once there, or not at all, and no step leads out. The fit once more from what the vehicle's file says of
/// it, the other numbers as they are; the better of the two.
[[nodiscard]] FitResult with_plausible_masses(const TrajectoryFit& problem, FitResult fit);

}  // namespace fathom::identification

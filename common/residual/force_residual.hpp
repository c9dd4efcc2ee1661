// What acts on the vehicle and the model lacks, as a force: for pictures, tests of whiteness and associations. No fit
// uses it.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/samples/trial.hpp"

namespace fathom::residual {

/// Samples, an odd number, over which a wrench residual is the mean: residuals that far apart share no measurement.
[[nodiscard]] std::size_t residual_span(double dt);

/// Standard deviation of the slope, per m/s (rad/s) of a velocity's white noise, 1/s.
[[nodiscard]] double slope_noise(double dt);

/// Weight of the samples up to `half` away from the middle in the mean acceleration that the slope of a straight line
/// through 2 half + 1 velocities is: acceleration runs straight from sample to sample.
[[nodiscard]] std::vector<double> acceleration_weights(std::size_t half);

/// Wrench residual X..N [N, N m] per sample, the mean over half a second: inertia times the slope of a straight line
/// through the measured velocity, less the model's load averaged as that slope averages acceleration (so that a step of
/// thrust within the span leaves nothing). NaN where the span meets an edge or an invalid sample, and on axes that are
/// not simulated or not measured.
[[nodiscard]] std::vector<Vector6d> wrench_residuals(const model::Model& model, const Trial& trial);
/// The same of several runs.
[[nodiscard]] std::vector<std::vector<Vector6d>> wrench_residuals(const model::Model& model,
                                                                  std::span<const Trial> trials);

/// Root mean square of such residuals [N, N m] by letter X Y Z K M N, of the axes that the vehicle is free in. Samples
/// without a residual do not count; an axis that has none is left out.
[[nodiscard]] std::map<std::string, double> force_rmse(const model::Vehicle& vehicle,
                                                       std::span<const std::vector<Vector6d>> residuals);

}  // namespace fathom::residual

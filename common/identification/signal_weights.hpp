// How much each signal of a window is worth, by what a model leaves of it.
#pragma once

#include <span>
#include <vector>

#include "common/identification/pose_window.hpp"

namespace fathom::identification {

/// Noise of ordinary instruments, in units of the signal: weights to begin with.
[[nodiscard]] double ordinary_noise(int signal);

/// Per window and row: one over the residual's standard deviation if it is white, less where it wanders: means over up
/// to `longest` seconds then vary more than white noise does, and what lasts is what parameters are told by. Outliers,
/// a signal of one window, weigh less.
[[nodiscard]] std::vector<Eigen::VectorXd> signal_weights(std::span<const PoseWindow> windows,
                                                          std::span<const Eigen::VectorXd> residuals, double longest);

}  // namespace fathom::identification

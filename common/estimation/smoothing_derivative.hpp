// Slope of a local polynomial (Savitzky and Golay 1964), its window as long as the vehicle's bandwidth allows.
#pragma once

#include <span>
#include <vector>

namespace fathom::estimation {

struct SmoothingDerivative {
  int half{};                  ///< samples on each side
  std::vector<double> weight;  ///< 1/s, from -half to +half
  double gain{};               ///< at the bandwidth; 1 is perfect
  double noise{};              ///< standard deviation of the slope over that of a sample, 1/s
};

/// The longest window (of a quartic) whose gain at `bandwidth` [Hz] is within `tolerance` of one; never under 5
/// samples.
[[nodiscard]] SmoothingDerivative smoothing_derivative(double step, double bandwidth, double tolerance);
/// Weights of the same slope at time 0 for samples at any times `t` [s], five at least, on both sides of 0.
[[nodiscard]] std::vector<double> slope_weights(std::span<const double> t);

}  // namespace fathom::estimation

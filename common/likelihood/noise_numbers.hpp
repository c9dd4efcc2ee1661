// The sizes of everything random, per axis: a force with a memory, a white force, sensor noise white and coloured, how
// heavy the innovations' tails are and whether their scale follows the recording.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fathom::likelihood {

/// Natural logarithms of: standard deviation [m/s^2 or rad/s^2] and memory [s] of the random acceleration
/// (Ornstein-Uhlenbeck); density of the white acceleration [m/s^2/sqrt(Hz)]; white noise of one sample of the sensor
/// [m/s or rad/s]; size and memory [s] of its coloured noise.
enum NoiseNumber : std::size_t { kForce, kForceMemory, kWhiteForce, kSensor, kColoured, kColourMemory };
constexpr std::size_t kNoiseNumbers = 6;
using NoiseLogs = std::array<double, kNoiseNumbers>;

/// Density of the innovations, for the score alone: the filter's gain stays that of Gaussian noise. Weights in the gain
/// take real accelerations for outliers.
struct Tail {
  double freedom{0.0};  ///< of Student's t; 0: Gaussian
  bool follows{false};  ///< the scale goes with the innovations' squares of the past second
  bool operator==(const Tail&) const = default;
};

struct AxisNoise {
  NoiseLogs log{};
  Tail tail{};
  [[nodiscard]] double operator[](NoiseNumber number) const { return std::exp(log[number]); }
};

/// Per simulated axis, in their order.
using Noise = std::vector<AxisNoise>;

/// What is assumed of the logarithms of one axis: Gaussian within bounds.
struct NoisePrior {
  NoiseLogs mean{}, sigma{}, low{}, high{};
  [[nodiscard]] double log_density(const NoiseLogs& log) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < kNoiseNumbers; ++i) {
      const double off = (log[i] - mean[i]) / sigma[i];
      sum -= 0.5 * off * off;
    }
    return sum;
  }
};

/// Scale of an axis' innovations as the recording's past tells it, in variance.
class FollowedScale {
 public:
  [[nodiscard]] double value(const Tail& tail) const { return tail.follows ? kFloor + (1.0 - kFloor) * mean_ : 1.0; }
  /// `square`: of the innovation over its standard deviation.
  void see(double square, double dt) {
    const double keep = std::exp(-dt / kMemory);
    mean_ = keep * mean_ + (1.0 - keep) * std::fmin(square, kMost);
  }

 private:
  static constexpr double kMemory = 1.0;  // s
  static constexpr double kFloor = 0.05;  // quiet does not mean exact
  static constexpr double kMost = 25.0;   // one outlier is no change of scale
  double mean_{1.0};
};

/// Log density of a whitened innovation and what the fit needs of it.
struct TailScore {
  double log_density{};  ///< without the logarithm of the whitening's determinant
  double slope{};        ///< - d log density / d innovation
  double information{};  ///< expected square of the slope
};

class TailDensity {
 public:
  explicit TailDensity(const Tail& tail) : freedom_{tail.freedom} {
    constant_ = freedom_ > 0.0
                    ? std::lgamma(0.5 * (freedom_ + 1.0)) - std::lgamma(0.5 * freedom_) - 0.5 * std::log(freedom_ * kPi)
                    : -0.5 * std::log(2.0 * kPi);
  }
  /// `scale`: of the variance.
  [[nodiscard]] TailScore operator()(double innovation, double scale) const {
    const double square = innovation * innovation / scale, off = constant_ - 0.5 * std::log(scale);
    if (freedom_ == 0.0) return {off - 0.5 * square, innovation / scale, 1.0 / scale};
    return {off - 0.5 * (freedom_ + 1.0) * std::log1p(square / freedom_),
            (freedom_ + 1.0) * innovation / (scale * freedom_ + innovation * innovation),
            (freedom_ + 1.0) / (freedom_ + 3.0) / scale};
  }

 private:
  static constexpr double kPi = 3.14159265358979323846;
  double freedom_;
  double constant_;
};

}  // namespace fathom::likelihood

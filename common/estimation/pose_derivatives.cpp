#include "common/estimation/pose_derivatives.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"
#include "common/estimation/smoothing_derivative.hpp"

namespace fathom::estimation {
namespace {

constexpr double kBandwidth = 1.0;  // Hz: underwater vehicles of this size answer slower
constexpr double kGainTolerance = 0.03;
constexpr double kBridged = 0.1 / kBandwidth;  // s without a sample: what is slower than the bandwidth runs on there
constexpr double kEqualSteps = 1e-3;           // of a step: whole microseconds pass

/// Samples under the derivative's window, at whatever times they were taken.
class Neighbours {
 public:
  Neighbours(const PoseSeries& pose, double step, const SmoothingDerivative& slope)
      : pose_{pose}, slope_{slope}, step_{step}, reach_{slope.half * step}, gap_{std::max(1.8 * step, kBridged)} {}

  /// False where one is not valid, or they are too far apart to say what was between them.
  bool around(std::size_t middle) {
    const auto& t = pose_.t;
    const double edge = reach_ - kEqualSteps * slope_.half * step_;
    begin_ = end_ = middle;
    while (t[middle] - t[begin_] < edge) {
      if (begin_ == 0 || t[begin_] - t[begin_ - 1] >= gap_ || pose_.valid[--begin_] == 0) return false;
    }
    while (t[end_] - t[middle] < edge) {
      if (end_ + 1 == t.size() || t[end_ + 1] - t[end_] >= gap_ || pose_.valid[++end_] == 0) return false;
    }
    if (pose_.valid[middle] == 0) return false;
    weigh(middle);
    return true;
  }
  [[nodiscard]] std::size_t begin() const { return begin_; }
  [[nodiscard]] std::size_t end() const { return end_ + 1; }
  [[nodiscard]] double weight(std::size_t sample) const { return weights()[sample - begin_]; }

 private:
  [[nodiscard]] const std::vector<double>& weights() const { return equal_ ? slope_.weight : own_; }
  void weigh(std::size_t middle) {
    equal_ = end_ - begin_ + 1 == slope_.weight.size();
    own_.clear();
    for (std::size_t j = begin_; j <= end_; ++j) {
      own_.push_back(pose_.t[j] - pose_.t[middle]);
      const double even = (static_cast<double>(j) - static_cast<double>(middle)) * step_;
      equal_ = equal_ && std::abs(own_.back() - even) < kEqualSteps * step_;
    }
    if (!equal_) own_ = slope_weights(own_);
  }

  const PoseSeries& pose_;
  const SmoothingDerivative& slope_;
  double step_, reach_, gap_;
  std::size_t begin_{}, end_{};
  bool equal_{};
  std::vector<double> own_;
};

}  // namespace

PoseDerivatives differentiate(const PoseSeries& pose) {
  PoseDerivatives result;
  const double step = typical_step(pose.t);
  if (step <= 0.0) return result;
  const SmoothingDerivative slope = smoothing_derivative(step, kBandwidth, kGainTolerance);
  result.velocity.bridged = result.rates.bridged = kBridged;
  Neighbours near{pose, step, slope};
  std::vector<double> before, t;
  std::array<std::vector<double>, 3> position, angle;  // for the noise: body-fixed increments would hide it
  for (std::size_t m = 1; m + 1 < pose.size(); ++m) {
    if (!near.around(m)) continue;
    Eigen::Vector3d v = Eigen::Vector3d::Zero(), w = Eigen::Vector3d::Zero();
    for (std::size_t j = near.begin(); j < near.end(); ++j) {
      v += near.weight(j) * pose.p_WB[j];
      if (pose.has_attitude)
        w += near.weight(j) * rotation_vector_from_quaternion(pose.q_WB[m].conjugate() * pose.q_WB[j]);
    }
    if (pose.has_position && pose.has_attitude) {
      result.velocity.series.t.push_back(pose.t[m]);
      result.velocity.series.x.push_back(pose.q_WB[m].conjugate() * v);
    }
    if (pose.has_attitude) {
      result.rates.series.t.push_back(pose.t[m]);
      result.rates.series.x.push_back(w);
    }
    const Eigen::Vector3d local = rotation_vector_from_quaternion(pose.q_WB[m - 1].conjugate() * pose.q_WB[m]);
    before.push_back(pose.t[m - 1]);
    t.push_back(pose.t[m]);
    for (std::size_t k = 0; k < 3; ++k) {
      position[k].push_back(pose.p_WB[m][static_cast<int>(k)]);
      angle[k].push_back(local[static_cast<int>(k)]);
    }
  }
  Eigen::Vector3d sigma_p, sigma_a;
  for (std::size_t k = 0; k < 3; ++k) {
    sigma_p[static_cast<int>(k)] = white_noise_sigma(t, position[k]);
    sigma_a[static_cast<int>(k)] = white_noise_of_steps(before, t, angle[k]);
  }
  // Horizontal axes mix with heading.
  sigma_p.head<2>().setConstant(std::sqrt(0.5 * sigma_p.head<2>().squaredNorm()));
  result.velocity.sigma = slope.noise * sigma_p;
  result.rates.sigma = slope.noise * sigma_a;
  return result;
}

}  // namespace fathom::estimation

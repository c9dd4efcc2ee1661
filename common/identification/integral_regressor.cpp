// phi(s) = 8/(3T) sin^4(pi s): four derivatives meet zero at the ends, so that the trapezoidal rule on uniform samples
// is exact but for a few millionths, on both sides alike. White velocity noise sigma at interval dt enters the mass
// column as an acceleration of variance 44 sigma^2 dt / T^3: at 5 mm/s, 0.1 s and 2 s that is 4 mm/s^2.
#include "common/identification/integral_regressor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "common/base/error.hpp"
#include "common/model/regressor.hpp"

namespace fathom::identification {
namespace {

constexpr std::size_t kFewestSamples = 8;   // the bump needs that many to be one
constexpr double kShortestShare = 0.8;      // of the window, when irregular samples do not fill it to the end
constexpr double kRoundingOfTime = 1.5e-6;  // s: stamps are whole microseconds

// Errors of two velocities in the moment of the masses along them: (m_a - m_b) v_a v_b about the third axis.
Eigen::Vector3d variance_of_moment(const Eigen::Vector3d& mass, const MotionSample& s) {
  Eigen::Vector3d variance;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Index a = (i + 1) % 3, b = (i + 2) % 3;
    variance[i] =
        std::pow(mass[a] - mass[b], 2) * (std::pow(s.nu[a] * s.sigma_v[b], 2) + std::pow(s.nu[b] * s.sigma_v[a], 2));
  }
  return variance;
}

}  // namespace

IntegralRegressor::IntegralRegressor(IntegralSettings settings) : settings_{std::move(settings)} {
  if (!(settings_.window > 0.0 && settings_.stride > 0.0 && settings_.max_gap > 0.0 && settings_.max_rate > 0.0)) {
    throw InputError("integral regressor: window, stride, max_gap and max_rate must be positive");
  }
  if (!(settings_.sigma.minCoeff() > 0.0)) throw InputError("integral regressor: noise must be positive on every axis");
  if (settings_.parameters.empty() || settings_.parameters.size() > static_cast<std::size_t>(kMaxParameters)) {
    throw InputError("integral regressor: needs between 1 and " + std::to_string(kMaxParameters) + " parameters");
  }
  ring_.resize(static_cast<std::size_t>(std::ceil(settings_.window * settings_.max_rate)) + kFewestSamples);
  average_.resize(ring_.size());
  derivative_.resize(ring_.size());
}

void IntegralRegressor::reset() {
  first_ = 0;
  size_ = 0;
  weighed_ = 0;
  took_ = false;
  last_rows_.reset();
}

std::optional<RowBlock> IntegralRegressor::step(const MotionSample& next) {
  took_ = false;
  if (!next.valid) {
    reset();
    return std::nullopt;
  }
  if (size_ > 0) {
    const double elapsed = seconds_between(sample(size_ - 1).utime, next.utime);
    if (elapsed <= 0.0 || elapsed > settings_.max_gap) {
      reset();
    } else if (elapsed + kRoundingOfTime < 1.0 / settings_.max_rate) {
      return std::nullopt;
    }
  }
  if (size_ == ring_.size()) {
    first_ = (first_ + 1) % ring_.size();
    --size_;
  }
  ring_[(first_ + size_) % ring_.size()] = next;
  ++size_;
  took_ = true;
  // Samples that no window will need again.
  while (seconds_between(sample(0).utime, next.utime) > settings_.window + kRoundingOfTime) {
    first_ = (first_ + 1) % ring_.size();
    --size_;
  }
  const double span = seconds_between(sample(0).utime, next.utime);
  const bool full = size_ >= kFewestSamples && span + settings_.max_gap > settings_.window &&
                    span > kShortestShare * settings_.window;
  if (!full) return std::nullopt;
  if (last_rows_ && seconds_between(*last_rows_, next.utime) + kRoundingOfTime < settings_.stride) return std::nullopt;
  last_rows_ = next.utime;
  return rows(size_);
}

// Trapezoidal weights, then a small correction of shape phi (a + b t) that makes the pair exact for velocities linear
// in time whatever the sample times: sum derivative = 0, sum derivative t = 1, sum average = 1.
void IntegralRegressor::weigh(std::size_t count) {
  const Utime origin = sample(0).utime;
  const double span = seconds_between(origin, sample(count - 1).utime);
  double sum = 0.0;
  double first_moment = 0.0;
  double second_moment = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double t = seconds_between(origin, sample(k).utime);
    const double left = k > 0 ? t - seconds_between(origin, sample(k - 1).utime) : 0.0;
    const double right = k + 1 < count ? seconds_between(origin, sample(k + 1).utime) - t : 0.0;
    const double share = 0.5 * (left + right);
    const double sine = std::sin(std::numbers::pi * t / span);
    const double cosine = std::cos(std::numbers::pi * t / span);
    const double scale = share * 8.0 / (3.0 * span) * sine * sine * sine;
    average_[k] = scale * sine;
    derivative_[k] = -scale * cosine * 4.0 * std::numbers::pi / span;
    sum += average_[k];
    first_moment += average_[k] * t;
    second_moment += average_[k] * t * t;
  }
  const double mean = first_moment / sum;
  const double spread = second_moment / sum - mean * mean;
  double offset = 0.0;
  double slope = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    average_[k] /= sum;
    offset += derivative_[k];
    slope += derivative_[k] * (seconds_between(origin, sample(k).utime) - mean);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const double t = seconds_between(origin, sample(k).utime) - mean;
    derivative_[k] += average_[k] * (-offset + (1.0 - slope) * t / spread);
  }
}

RowBlock IntegralRegressor::rows(std::size_t count) {
  weigh(count);
  weighed_ = count;
  model::BaseRegressor Y = model::BaseRegressor::Zero();
  Vector6d tau = Vector6d::Zero();
  Eigen::Vector3d known = Eigen::Vector3d::Zero(), moment = known;  // variances of u v w, and of what they make
  for (std::size_t k = 0; k < count; ++k) {
    const MotionSample& s = sample(k);
    known += average_[k] * s.sigma_v.cwiseAbs2();
    moment += average_[k] * variance_of_moment(settings_.mass, s);
    Y += average_[k] * model::motion_regressor(s.nu, s.down_B);
    Y.diagonal() += derivative_[k] * s.nu;
    tau += average_[k] * s.tau;
  }
  RowBlock block;
  block.end = sample(count - 1).utime;
  block.utime = sample(0).utime + (block.end - sample(0).utime) / 2;
  for (int axis = 0; axis < 6; ++axis) {
    if (!settings_.dof[static_cast<std::size_t>(axis)]) continue;
    Row& row = block.rows[static_cast<std::size_t>(block.count++)];
    row.axis = axis;
    row.h.resize(static_cast<Eigen::Index>(settings_.parameters.size()));
    for (Eigen::Index i = 0; i < row.h.size(); ++i) {
      row.h(i) = Y(axis, model::index(settings_.parameters[static_cast<std::size_t>(i)]));
    }
    const auto inertia = std::ranges::find(settings_.parameters, static_cast<model::BaseParameter>(axis));
    row.derivative =
        inertia == settings_.parameters.end() ? -1 : static_cast<int>(inertia - settings_.parameters.begin());
    row.y = tau(axis);
    row.variance = settings_.sigma(axis) * settings_.sigma(axis);
    if (axis < 3) {
      const double worse = std::max(0.0, known(axis) - settings_.ordinary_sigma_v * settings_.ordinary_sigma_v);
      row.variance += settings_.per_velocity(axis) * settings_.per_velocity(axis) * worse;
    } else {
      row.variance += moment(axis - 3);
    }
  }
  return block;
}

}  // namespace fathom::identification

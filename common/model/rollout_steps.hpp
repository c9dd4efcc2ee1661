// The inside of a rollout: state, midpoint steps, run-in of memories. Only rollout.cpp and sensitivity.cpp include it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/model/derivatives/sensitivity.hpp"
#include "common/model/rollout.hpp"

namespace fathom::model {

constexpr double kLargestStep = 0.05;   // s: an oscillation or a turn of 1 rad/s is followed to 1e-3
constexpr double kMostDamping = 1.5;    // of one step, by which the base drag's own change within it stays small
constexpr double kShortestStep = 0.02;  // s: what is faster decays exactly anyway
constexpr double kTypicalSpeed = 0.5;   // m/s, rad/s, where quadratic drag is taken to choose the step
constexpr double kAbsurd = 50.0;        // m/s or rad/s: no vehicle of ours moves like that
constexpr int kMaxMemory = 256;

// Where what a velocity does within a step adds up in the pose: places tell the masses of a ROV to 1e-4 over half a
// minute, and that needs 10 ms. What is slower needs less.
constexpr double kPoseDamping = 0.04;        // of one step
constexpr double kShortestPoseStep = 0.005;  // s

/// Step that follows the fastest motion of the priors: the same for every theta, so that derivatives see no change of
/// it.
inline double largest_step(const Vehicle& vehicle, bool poses) {
  const double quickest = quickest_decay(vehicle);
  return poses ? std::clamp(kPoseDamping * quickest, kShortestPoseStep, kLargestStep)
               : std::clamp(kMostDamping * quickest, kShortestStep, kLargestStep);
}

/// What a step with decay z >= 0 makes of a constant slope, (1 - exp(-z)) / z, and of one that grows from 0 to 1 over
/// the step, (exp(-z) - 1 + z) / z^2; the former also for half of z. Elementwise, and their derivatives with respect to
/// z (half of z): one exponential tells them all.
struct StepShares {
  Vector6d half, whole, growth;
  Vector6d half_slope, whole_slope, growth_slope;  ///< only when asked for

  StepShares(const Vector6d& decays, bool with_slopes) {
    // With y = z / 2 and g(y) = (exp(-y) - 1 + y) / y^2, of which a series tells all and nothing cancels.
    const Vector6d y = 0.5 * decays;
    const Vector6d g = horner(kGrowth, y);
    half = Vector6d::Ones() - y.cwiseProduct(g);
    const Vector6d rest = Vector6d::Ones() - 0.5 * y.cwiseProduct(half);
    whole = half.cwiseProduct(rest);
    growth = 0.5 * g + 0.25 * half.cwiseProduct(half);
    if (with_slopes) {
      const Vector6d g_slope = horner(kGrowthSlope, y);
      half_slope = -g - y.cwiseProduct(g_slope);
      whole_slope = 0.5 * half_slope.cwiseProduct(rest) - 0.25 * half.cwiseProduct(half + y.cwiseProduct(half_slope));
      growth_slope = 0.25 * (g_slope + half.cwiseProduct(half_slope));
    }
    for (Eigen::Index i = 0; i < 6; ++i) {
      if (y[i] > kLongestSeries) set_stiff(i, decays[i], with_slopes);
    }
  }

 private:
  static constexpr double kLongestSeries = 0.75;  // what is left out below it is under 1e-11
  static constexpr std::size_t kTerms = 13;
  using Series = std::array<double, kTerms>;
  /// g(y) = sum (-y)^n / (n + 2)!
  static constexpr Series kGrowth = [] {
    Series series{};
    double term = 0.5;
    for (std::size_t n = 0; n < kTerms; ++n, term /= -static_cast<double>(n + 2)) series[n] = term;
    return series;
  }();
  static constexpr Series kGrowthSlope = [] {
    Series series{};
    for (std::size_t n = 0; n + 1 < kTerms; ++n) series[n] = static_cast<double>(n + 1) * kGrowth[n + 1];
    return series;
  }();

  static Vector6d horner(const Series& series, const Vector6d& y) {
    Vector6d sum = Vector6d::Constant(series[kTerms - 1]);
    for (std::size_t n = kTerms - 1; n-- > 0;) sum = (sum.cwiseProduct(y).array() + series[n]).matrix();
    return sum;
  }

  void set_stiff(Eigen::Index i, double z, bool with_slopes) {
    const double y = 0.5 * z, e = std::expm1(-y), all = e * (2.0 + e);  // exp(-y) - 1, exp(-z) - 1
    half[i] = -e / y;
    whole[i] = -all / z;
    growth[i] = (all + z) / (z * z);
    if (!with_slopes) return;
    half_slope[i] = (e + y + e * y) / (y * y);
    whole_slope[i] = (all + z + all * z) / (z * z);
    growth_slope[i] = -(2.0 * z + all * (2.0 + z)) / (z * z * z);
  }
};

/// Where the body's x axis points, seen from above: cosine and sine of the heading times the cosine of pitch.
inline Eigen::Vector2d bow(const Eigen::Quaterniond& q) {
  return {1.0 - 2.0 * (q.y() * q.y() + q.z() * q.z()), 2.0 * (q.w() * q.z() + q.x() * q.y())};
}

/// The tilt of one attitude with the heading of another.
inline Eigen::Quaterniond with_heading(const Eigen::Quaterniond& tilt, const Eigen::Quaterniond& heading) {
  const Eigen::Vector2d from = bow(tilt), to = bow(heading);
  const double size = std::sqrt(from.squaredNorm() * to.squaredNorm());
  if (size < 1e-12) return tilt;  // straight up or down: there is no heading
  const double along = from.dot(to), across = from.x() * to.y() - from.y() * to.x();
  // Half of the turn between them; each formula where it is exact.
  if (along > 0.0) {
    const double scale = 1.0 / std::sqrt(2.0 * size * (size + along));
    return Eigen::Quaterniond(scale * (size + along), 0.0, 0.0, scale * across) * tilt;
  }
  const double half_cosine = std::sqrt(0.5 * std::max(1.0 + along / size, 0.0));
  const double half_sine = std::copysign(std::sqrt(0.5 * (1.0 - along / size)), across);
  return Eigen::Quaterniond(half_cosine, 0.0, 0.0, half_sine) * tilt;
}

/// State of one rollout and the step that advances it.
class Rollout {
 public:
  Rollout(const Model& model, const Trial& trial, Sensitivity* sensitivity = nullptr)
      : model_{model},
        trial_{trial},
        input_{input_of(model, trial)},
        memory_size_{model.memory_size()},
        sensitivity_{sensitivity} {
    if (memory_size_ > kMaxMemory) throw std::length_error("the model's effects remember more than a rollout can hold");
    const auto& dof = model.vehicle->dof;
    tilt_measured_ = !(dof[3] && dof[4]);
    heading_measured_ = !dof[5];
    all_simulated_ = std::all_of(dof.begin(), dof.end(), [](bool free) { return free; });
    motion_.input = &input_;
    motion_.vehicle = model.vehicle;
    memory_.fill(0.0);
  }

  bool run(const Window& window, const Vector6d& nu0, VelocityTrace& nu, const PoseShift& shift = {},
           PoseTrace* pose = nullptr) {
    // Each part of a step has a mean input of its own, which only whole substeps can follow.
    const auto parts = static_cast<int>(trial_.parts());
    const double part = trial_.dt / parts;
    const int substeps =
        parts * std::max(1, static_cast<int>(std::ceil(part / largest_step(*model_.vehicle, pose != nullptr) - 1e-9)));
    const double h = trial_.dt / substeps;
    run_in(window.start, h);
    nu_ = measured_where_fixed(window.start, 0.0, nu0);
    p_ = trial_.p_WB[window.start] + shift.p_W;
    q_ = quaternion_from_rotation_vector(shift.turn_W) * trial_.q_WB[window.start];
    nu.resize(6, static_cast<Eigen::Index>(window.count));
    nu.col(0) = nu_;
    if (pose != nullptr) {
      follow_measured_attitude(window.start, 0.0);
      pose->p_WB.resize(3, static_cast<Eigen::Index>(window.count));
      pose->q_WB.resize(window.count);
      record(*pose, 0);
    }
    if (sensitivity_ != nullptr) sensitivity_->begin(model_, window.count);
    for (std::size_t k = 1; k < window.count; ++k) {
      const std::size_t from = window.start + k - 1;
      for (int s = 0; s < substeps; ++s) step(from, s * h, h);
      if (!nu_.allFinite() || nu_.cwiseAbs().maxCoeff() > kAbsurd) {
        for (std::size_t rest = k; rest < window.count; ++rest) {
          nu.col(static_cast<Eigen::Index>(rest)) = nu.col(static_cast<Eigen::Index>(k - 1));
          if (sensitivity_ != nullptr) sensitivity_->record(rest);
          if (pose != nullptr) record(*pose, rest);
        }
        return false;
      }
      nu.col(static_cast<Eigen::Index>(k)) = nu_;
      if (pose != nullptr) record(*pose, k);
      if (sensitivity_ != nullptr) sensitivity_->record(k);
    }
    return true;
  }

  // Acceleration at an instant; effects' memory first advances by dt with the command of the middle of that time.
  Vector6d felt_acceleration(std::size_t from, double offset, const Eigen::Vector3d& p, const Eigen::Quaterniond& q,
                             const Vector6d& nu, double dt) {
    set_motion(from, offset, p, q, nu);
    if (memory_size_ > 0 && dt > 0.0) {
      Motion middle = motion_;
      middle.t -= 0.5 * dt;
      input_.now(middle.t, middle.force);
      feel(model_, middle, memory(), dt);
    }
    feel(model_, motion_, memory(), 0.0);
    return acceleration(model_, motion_);
  }

  /// The motion of the last call of felt_acceleration, as felt.
  [[nodiscard]] const Motion& motion() const { return motion_; }
  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] bool tilt_measured() const { return tilt_measured_; }
  [[nodiscard]] bool heading_measured() const { return heading_measured_; }

 private:
  std::span<double> memory() { return {memory_.data(), static_cast<std::size_t>(memory_size_)}; }

  // Rates at which the base model's drag slows each axis [1/s].
  Vector6d damping(const Vector6d& nu) const {
    const auto& theta = model_.theta;
    const Vector6d slope = theta.segment<6>(index(BaseParameter::X_u)) +
                           2.0 * theta.segment<6>(index(BaseParameter::X_uu)).cwiseProduct(nu.cwiseAbs());
    return (-slope.cwiseQuotient(theta.head<6>())).cwiseMax(0.0).unaryExpr([](double x) {
      return std::isfinite(x) ? x : 0.0;
    });
  }

  // Velocity with the left-out degrees of freedom taken from the measurement, `offset` seconds after sample `from`.
  Vector6d measured_where_fixed(std::size_t from, double offset, const Vector6d& simulated) const {
    if (all_simulated_) return simulated;
    const std::size_t next = std::min(from + 1, trial_.size() - 1);
    const double share = offset / trial_.dt;
    Vector6d nu = simulated;
    for (Eigen::Index i = 0; i < 6; ++i) {
      if (!model_.vehicle->dof[static_cast<std::size_t>(i)]) {
        nu[i] = (1.0 - share) * trial_.nu[from][i] + share * trial_.nu[next][i];
      }
    }
    return nu;
  }

  /// Of the measurement, in the left-out degrees of freedom: its integral is exactly what was measured.
  Vector6d told_slope(std::size_t from) const {
    const std::size_t next = std::min(from + 1, trial_.size() - 1);
    Vector6d slope = Vector6d::Zero();
    for (Eigen::Index i = 0; i < 6; ++i) {
      if (!model_.vehicle->dof[static_cast<std::size_t>(i)])
        slope[i] = (trial_.nu[next][i] - trial_.nu[from][i]) / trial_.dt;
    }
    return slope;
  }

  void set_motion(std::size_t from, double offset, const Eigen::Vector3d& p, const Eigen::Quaterniond& q,
                  const Vector6d& nu) {
    motion_.t = trial_.t[from] + offset;
    motion_.p_WB = p;
    motion_.R_WB = q.toRotationMatrix();
    motion_.nu = nu;
    if (!all_simulated_) motion_.nu_dot_told = told_slope(from);
    motion_.v_WF_B.setZero();
    motion_.a_WF_B.setZero();
    motion_.w_memory.setZero();
    input_.now(motion_.t, motion_.force);
    motion_.voltage = trial_.voltage.empty() ? 0.0 : trial_.voltage[from];
    if (!trial_.columns.empty())
      motion_.columns = {trial_.columns[from].data(), static_cast<std::size_t>(trial_.columns[from].size())};
  }

  void step(std::size_t from, double offset, double h) {
    // Midpoint rule with exact decay (exponential time differencing of second order, Cox and Matthews 2002, sec. 2.2):
    // the drag's slope at the step's start decays exactly, and the rest runs on a straight line through start and
    // middle, so that no time constant is too short for the step. The plain rule's decay is slow by a sixth of the
    // square of damping times step, and a fit would make the inertia that much too small.
    const double half = 0.5 * h;
    const Vector6d decay = damping(nu_);
    const Vector6d k1 = felt_acceleration(from, offset, p_, q_, nu_, half);
    const Eigen::Vector3d p_half = p_ + half * (motion_.R_WB * nu_.head<3>());
    const StepShares shares{h * decay, sensitivity_ != nullptr};
    const Vector6d nu_half = measured_where_fixed(from, offset + half, nu_ + half * shares.half.cwiseProduct(k1));
    const Eigen::Quaterniond q_half = q_ * quaternion_from_rotation_vector(half * nu_.tail<3>());
    const Vector6d k2 = felt_acceleration(from, offset + half, p_half, q_half, nu_half, half);
    if (sensitivity_ != nullptr)
      sensitivity_->advance(*this, {from, offset + half, p_half, q_half, nu_half, k2, decay, nu_, k1, shares}, h);
    const Vector6d change = k2 + decay.cwiseProduct(nu_half - nu_) - k1;
    const Vector6d slope = shares.whole.cwiseProduct(k1) + 2.0 * shares.growth.cwiseProduct(change);
    const Vector6d nu_end = measured_where_fixed(from, offset + h, nu_ + h * slope);
    // What settles within few steps is no straight line: Simpson's mean over the step.
    const Vector6d mean = (nu_ + 4.0 * nu_half + nu_end) / 6.0;
    p_ += h * (q_half * mean.head<3>());
    q_ = (q_ * quaternion_from_rotation_vector(h * mean.tail<3>())).normalized();
    nu_ = nu_end;
    follow_measured_attitude(from, offset + h);
  }

  void follow_measured_attitude(std::size_t from, double offset) {
    if (!tilt_measured_ && !heading_measured_) return;
    const std::size_t next = std::min(from + 1, trial_.size() - 1);
    const double share = std::min(offset / trial_.dt, 1.0);
    Eigen::Quaterniond measured = trial_.q_WB[next];
    if (share < 1.0 - 1e-9) {  // a straight line: what a vehicle turns in a sample is little
      const Eigen::Quaterniond& before = trial_.q_WB[from];
      const double way = before.dot(measured) < 0.0 ? -1.0 : 1.0;
      measured.coeffs() = (1.0 - share) * way * before.coeffs() + share * measured.coeffs();
      measured.normalize();
    }
    q_ = tilt_measured_ && heading_measured_ ? measured
         : tilt_measured_                    ? with_heading(measured, q_)
                                             : with_heading(q_, measured);
  }

  void record(PoseTrace& pose, std::size_t k) const {
    pose.p_WB.col(static_cast<Eigen::Index>(k)) = p_;
    pose.q_WB[k] = q_;
  }

  void run_in(std::size_t start, double h) {
    if (memory_size_ == 0) return;
    double seconds = 0.0;
    for (const ActiveEffect& active : model_.effects) seconds = std::max(seconds, active.effect->run_in(active.theta));
    const auto back = static_cast<std::size_t>(seconds / trial_.dt);
    const std::size_t first = start > back ? start - back : 0;
    set_motion(first, 0.0, trial_.p_WB[first], trial_.q_WB[first], trial_.nu[first]);
    settle(model_, motion_, memory());
    const int substeps = static_cast<int>(std::lround(trial_.dt / h));
    for (std::size_t k = first; k < start; ++k) {
      for (int s = 0; s < substeps; ++s) {
        set_motion(k, (s + 0.5) * h, trial_.p_WB[k], trial_.q_WB[k], trial_.nu[k]);
        feel(model_, motion_, memory(), h);
      }
    }
  }

  const Model& model_;
  const Trial& trial_;
  InputSignal input_;
  int memory_size_;
  Sensitivity* sensitivity_;
  bool tilt_measured_{};
  bool heading_measured_{};
  bool all_simulated_{};
  std::array<double, kMaxMemory> memory_{};
  Motion motion_;
  Eigen::Vector3d p_{Eigen::Vector3d::Zero()};
  Eigen::Quaterniond q_{Eigen::Quaterniond::Identity()};
  Vector6d nu_{Vector6d::Zero()};
};

}  // namespace fathom::model

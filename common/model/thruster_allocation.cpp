#include "common/model/thruster_allocation.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/least_squares.hpp"
#include "common/base/motions.hpp"
#include "common/model/driven_axes.hpp"

namespace fathom::model {
namespace {

constexpr double kNoForce = 1e-9;         // N
constexpr double kReachTolerance = 1e-6;  // of a unit wrench
constexpr double kHardly = 0.01;  // of a thruster's force, or of its farthest arm: what is less is an error of drawing

std::string_view motion_name(Eigen::Index axis) { return kMotionNames[static_cast<std::size_t>(axis)]; }

}  // namespace

ThrusterAllocation::ThrusterAllocation(const Vehicle& vehicle, double largest) : vehicle_{vehicle}, largest_{largest} {
  if (!vehicle.has_thrusters()) {
    throw InputError("vehicle " + vehicle.name + ": 'thrusters' are needed to drive it; add them to its file");
  }
  // Free motions that the thrusters do not drive are left alone like those outside `dof`.
  vehicle_.dof = driven_axes(vehicle);
  if (std::ranges::none_of(vehicle_.dof, std::identity{})) {
    throw InputError("vehicle " + vehicle.name +
                     ": its thrusters produce none of the motions in 'dof' by itself; "
                     "correct their positions and axes");
  }
  // Degrees of freedom that the vehicle does not control are left alone, not forced to zero.
  Eigen::MatrixXd rows = vehicle.allocation;
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!vehicle_.dof[static_cast<std::size_t>(i)]) rows.row(i).setZero();
  }
  inverse_ = pseudo_inverse(rows);
  double farthest = 0.0;  // m
  for (const Thruster& thruster : vehicle.thrusters) farthest = std::max(farthest, thruster.p_BJ.norm());
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!vehicle_.dof[static_cast<std::size_t>(i)]) {
      inverse_.col(i).setZero();
    } else if ((rows * inverse_.col(i) - Vector6d::Unit(i)).norm() > kReachTolerance) {
      throw InputError("vehicle " + vehicle.name + ": its thrusters cannot produce " + std::string{motion_name(i)} +
                       " by itself; correct their positions and axes, or leave it out of 'dof'");
    }
    if (!vehicle_.dof[static_cast<std::size_t>(i)]) continue;
    // With the strongest thruster at 1 N the others do what keeps it to this axis.
    const double reach = 1.0 / inverse_.col(i).cwiseAbs().maxCoeff();
    if (reach < kHardly * (i < 3 ? 1.0 : farthest)) {
      char amount[48];
      std::snprintf(amount, sizeof amount, i < 3 ? "%.2g N per newton" : "%.2g m of arm", reach);
      throw InputError("vehicle " + vehicle.name + ": its thrusters hardly produce " + std::string{motion_name(i)} +
                       " (" + amount + "); correct their positions and axes, or leave it out of 'dof'");
    }
  }
}

std::string ThrusterAllocation::complaint(const Allocated& allocated) const {
  std::string names;
  for (std::size_t i = 0; i < 6; ++i) {
    if (allocated.missing[i])
      names += (names.empty() ? "" : ", ") + std::string{motion_name(static_cast<Eigen::Index>(i))};
  }
  if (names.empty()) return {};
  return "commanded " + names + ", which the thrusters of " + vehicle_.name +
         " cannot produce; it is left out (see 'dof' of the vehicle file)";
}

double ThrusterAllocation::voltage_factor(double battery) const {
  const ThrustCurve& curve = vehicle_.curve;
  if (battery <= 0.0 || curve.voltage <= 0.0) return 1.0;
  return std::pow(battery / curve.voltage, curve.voltage_exponent);
}

// The curve read from force to pulse width; flat about neutral, where no force is neutral itself.
double ThrusterAllocation::pwm_of(double force, double sign, double battery) const {
  const ThrustCurve& curve = vehicle_.curve;
  double pwm = curve.neutral_us;
  if (std::abs(force) > kNoForce) {
    const double wanted = std::clamp(force / voltage_factor(battery), curve.force.front(), curve.force.back());
    const auto above = std::lower_bound(curve.force.begin(), curve.force.end(), wanted);
    const auto i = std::max<std::ptrdiff_t>(1, above - curve.force.begin());
    const auto k = static_cast<std::size_t>(i);
    const double step = curve.force[k] - curve.force[k - 1];
    const double part = step > 0.0 ? (wanted - curve.force[k - 1]) / step : 1.0;
    pwm = curve.pwm_us[k - 1] + part * (curve.pwm_us[k] - curve.pwm_us[k - 1]);
  }
  return sign < 0.0 ? 2.0 * curve.neutral_us - pwm : pwm;
}

Allocated ThrusterAllocation::applied(const std::vector<double>& pwm_us, double battery) const {
  Allocated result{.pwm_us = pwm_us, .force = std::vector<double>(count(), 0.0)};
  Eigen::VectorXd force{static_cast<Eigen::Index>(count())};
  for (std::size_t i = 0; i < count(); ++i) {
    const double volts = battery > 0.0 ? battery : vehicle_.curve.voltage;
    result.force[i] = vehicle_.curve.force_at(pwm_us[i], vehicle_.thrusters[i].pwm_sign, volts);
    force(static_cast<Eigen::Index>(i)) = result.force[i];
  }
  result.tau = vehicle_.allocation * force;
  return result;
}

Allocated ThrusterAllocation::applied_forces(const std::vector<double>& force) const {
  const Eigen::Map<const Eigen::VectorXd> each{force.data(), static_cast<Eigen::Index>(force.size())};
  return {.force = force, .tau = vehicle_.allocation * each};
}

Allocated ThrusterAllocation::neutral() const {
  if (vehicle_.curve.empty()) return {.force = std::vector<double>(count(), 0.0)};
  return applied(std::vector<double>(count(), vehicle_.curve.neutral_us), 0.0);
}

Allocated ThrusterAllocation::allocate(const Vector6d& tau, double battery) const {
  const Eigen::VectorXd wanted = inverse_ * tau;
  const bool curved = !vehicle_.curve.empty();
  const double factor = voltage_factor(battery);
  const double most = curved ? std::min(largest_, factor * vehicle_.curve.force.back()) : largest_;
  const double least = curved ? std::min(largest_, -factor * vehicle_.curve.force.front()) : largest_;
  double scale = 1.0;
  for (Eigen::Index i = 0; i < wanted.size(); ++i) {
    const double limit = wanted(i) > 0.0 ? most : least;
    if (std::abs(wanted(i)) > kNoForce) scale = std::min(scale, std::max(0.0, limit) / std::abs(wanted(i)));
  }
  Allocated result;
  if (curved) {
    std::vector<double> pwm(count());
    for (std::size_t i = 0; i < count(); ++i) {
      const double force = scale * wanted(static_cast<Eigen::Index>(i));
      pwm[i] = pwm_of(force, vehicle_.thrusters[i].pwm_sign, battery);
    }
    result = applied(pwm, battery);
  } else {
    const Eigen::VectorXd force = scale * wanted;
    result.force.assign(force.begin(), force.end());
    result.tau = vehicle_.allocation * force;
  }
  result.scale = scale;
  for (std::size_t i = 0; i < 6; ++i) {
    result.missing[i] = !vehicle_.dof[i] && std::abs(tau(static_cast<Eigen::Index>(i))) > kNoForce;
  }
  return result;
}

}  // namespace fathom::model

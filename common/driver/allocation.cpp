#include "common/driver/allocation.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"

namespace fathom::driver {
namespace {

constexpr double kNoForce = 1e-9;  // N

}  // namespace

Allocation::Allocation(const model::Vehicle& vehicle, double largest) : vehicle_{vehicle}, largest_{largest} {
  if (!vehicle.has_thrusters() || vehicle.curve.empty()) {
    throw InputError("vehicle " + vehicle.name + ": 'thrusters' and 'thrust_curve' are needed to drive it; add them");
  }
  // Degrees of freedom that the vehicle does not control are left alone, not forced to zero.
  Eigen::MatrixXd rows = vehicle.allocation;
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!vehicle.dof[static_cast<std::size_t>(i)]) rows.row(i).setZero();
  }
  inverse_ = rows.completeOrthogonalDecomposition().pseudoInverse();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!vehicle.dof[static_cast<std::size_t>(i)]) inverse_.col(i).setZero();
  }
}

double Allocation::voltage_factor(double battery) const {
  const model::ThrustCurve& curve = vehicle_.curve;
  if (battery <= 0.0 || curve.voltage <= 0.0) return 1.0;
  return std::pow(battery / curve.voltage, curve.voltage_exponent);
}

// The curve read from force to pulse width; flat about neutral, where no force is neutral itself.
double Allocation::pwm_of(double force, double sign, double battery) const {
  const model::ThrustCurve& curve = vehicle_.curve;
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

Allocated Allocation::applied(const std::vector<double>& pwm_us, double battery) const {
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

Allocated Allocation::neutral() const { return applied(std::vector<double>(count(), vehicle_.curve.neutral_us), 0.0); }

Allocated Allocation::allocate(const Vector6d& tau, double battery) const {
  const Eigen::VectorXd wanted = inverse_ * tau;
  const double factor = voltage_factor(battery);
  double scale = 1.0;
  for (Eigen::Index i = 0; i < wanted.size(); ++i) {
    const double limit = wanted(i) > 0.0 ? std::min(largest_, factor * vehicle_.curve.force.back())
                                         : std::min(largest_, -factor * vehicle_.curve.force.front());
    if (std::abs(wanted(i)) > kNoForce) scale = std::min(scale, std::max(0.0, limit) / std::abs(wanted(i)));
  }
  std::vector<double> pwm(count());
  for (std::size_t i = 0; i < count(); ++i) {
    const double force = scale * wanted(static_cast<Eigen::Index>(i));
    pwm[i] = pwm_of(force, vehicle_.thrusters[i].pwm_sign, battery);
  }
  Allocated result = applied(pwm, battery);
  result.scale = scale;
  return result;
}

}  // namespace fathom::driver

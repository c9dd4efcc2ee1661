#include "common/estimation/thruster_forces.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/actuators.hpp"

namespace fathom::estimation {

double voltage_at(const std::vector<Battery>& battery, Utime utime) {
  if (battery.empty()) return 0.0;
  const auto after =
      std::lower_bound(battery.begin(), battery.end(), utime, [](const Battery& b, Utime t) { return b.utime < t; });
  if (after == battery.begin()) return after->voltage;
  if (after == battery.end()) return battery.back().voltage;
  const auto before = after - 1;
  const double share = static_cast<double>(utime - before->utime) / static_cast<double>(after->utime - before->utime);
  return before->voltage + share * (after->voltage - before->voltage);
}

double reference_voltage(const model::Vehicle& vehicle) {
  return vehicle.curve.voltage > 0.0 ? vehicle.curve.voltage : std::max(vehicle.nominal_voltage, 1.0);
}

std::vector<double> forces_of(const ThrusterCorrection& correction, const model::Vehicle& vehicle,
                              const std::vector<double>& pwm_us, double voltage) {
  const double factor = correction.scale * std::pow(voltage / reference_voltage(vehicle), correction.exponent);
  std::vector<double> force = model::forces_of_commands(vehicle, pwm_us, voltage);
  for (std::size_t k = 0; k < force.size(); ++k) {
    if (vehicle.thrusters[k].command == model::CommandKind::kForce) force[k] *= factor;
  }
  return force;
}

ThrusterForces::ThrusterForces(const ThrusterCorrection& correction, model::Vehicle vehicle)
    : correction_{correction}, vehicle_{std::move(vehicle)} {}

void ThrusterForces::step(const Battery& battery) {
  if (battery.voltage > 0.0 && (!battery_ || battery.utime >= battery_->utime)) battery_ = battery;
}

Thrusters ThrusterForces::step(const Thrusters& thrusters) const {
  Thrusters result = thrusters;
  if (result.force.empty() && correction_.use_commands && result.pwm_us.size() == vehicle_.thrusters.size()) {
    const double voltage = battery_ ? battery_->voltage : reference_voltage(vehicle_);
    result.force = forces_of(correction_, vehicle_, result.pwm_us, voltage);
  }
  return result;
}

}  // namespace fathom::estimation

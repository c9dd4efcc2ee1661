#include "common/estimation/thruster_forces.hpp"

#include <algorithm>
#include <cmath>

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

ThrusterForces::ThrusterForces(const ThrusterCorrection& correction, model::Vehicle vehicle)
    : correction_{correction}, vehicle_{std::move(vehicle)} {
  reference_ = vehicle_.curve.voltage > 0.0 ? vehicle_.curve.voltage : std::max(vehicle_.nominal_voltage, 1.0);
}

void ThrusterForces::step(const Battery& battery) {
  if (battery.voltage > 0.0 && (!battery_ || battery.utime >= battery_->utime)) battery_ = battery;
}

Thrusters ThrusterForces::step(const Thrusters& thrusters) const {
  Thrusters result = thrusters;
  if (!result.force.empty() || !correction_.use_commands || result.pwm_us.size() != vehicle_.thrusters.size()) {
    return result;
  }
  const double voltage = battery_ ? battery_->voltage : reference_;
  const double factor = correction_.scale * std::pow(voltage / reference_, correction_.exponent);
  for (std::size_t k = 0; k < result.pwm_us.size(); ++k) {
    result.force.push_back(factor * vehicle_.curve.force_at(result.pwm_us[k], vehicle_.thrusters[k].pwm_sign, voltage));
  }
  return result;
}

}  // namespace fathom::estimation

// From commands to forces on line, the way the offline fit does it: curve, battery voltage, and the correction that the
// consistency check found.
#pragma once

#include <optional>
#include <vector>

#include "common/estimation/corrections.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/sensors.hpp"

namespace fathom::estimation {

/// Voltage [V] at `utime`: linear between samples, held at the ends, 0 when none was logged.
[[nodiscard]] double voltage_at(const std::vector<Battery>& battery, Utime utime);

/// Voltage [V] to which a correction's exponent refers: the curve's, else the vehicle's nominal one.
[[nodiscard]] double reference_voltage(const model::Vehicle& vehicle);
/// Force [N] of every thruster at its command and `voltage` [V]. One command per thruster.
[[nodiscard]] std::vector<double> forces_of(const ThrusterCorrection& correction, const model::Vehicle& vehicle,
                                            const std::vector<double>& pwm_us, double voltage);

class ThrusterForces {
 public:
  ThrusterForces(const ThrusterCorrection& correction, model::Vehicle vehicle);
  void step(const Battery& battery);
  /// The sample with `force` filled in where the correction says that commands are to be trusted; else as it came.
  [[nodiscard]] Thrusters step(const Thrusters& thrusters) const;
  void reset() { battery_.reset(); }

 private:
  ThrusterCorrection correction_;
  model::Vehicle vehicle_;
  std::optional<Battery> battery_;
};

}  // namespace fathom::estimation

// A plain protocol for test rigs: NMEA sentences with pulse widths out, and what was applied and the battery in.
#pragma once

#include <array>
#include <span>
#include <string>

#include "common/devices/nmea.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// To the rig: "$FTPWM,1500,1620,...*hh", microseconds in the order of the vehicle file. A rig goes to neutral when
/// none came for half a second.
[[nodiscard]] std::string thruster_sentence(std::span<const double> pwm_us);

/// From the rig: "$FTAPP,1500,1618,...*hh" (applied), "$FTBAT,16.2*hh" (V).
class ThrusterText final : public NmeaParser {
 public:
  explicit ThrusterText(const Settings& settings);

 private:
  void sentence(const Words& words, Frame& frame) override;
  void describe_values(Fields& fields) const override;

  std::optional<double> voltage_;
  Battery battery_;
  Thrusters thrusters_;
};

}  // namespace fathom::devices

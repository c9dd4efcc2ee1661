// A plain protocol for test rigs: NMEA sentences with pulse widths or forces out, and what was applied and the battery
// in.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "common/devices/nmea.hpp"
#include "common/devices/settings.hpp"
#include "common/samples/vehicle_condition.hpp"

namespace fathom::devices {

/// To the rig: "$FTPWM,1500,1620,...*hh", microseconds in the order of the vehicle file. A rig goes to neutral when
/// none came for half a second.
[[nodiscard]] std::string thruster_sentence(std::span<const double> pwm_us);
/// The same for thrusters that regulate their force themselves: "$FTFRC,3.250,-1.100,...*hh", N.
[[nodiscard]] std::string force_sentence(std::span<const double> force);

/// What a rig says of itself: "$FTSTA,armed,mode,failsafe*hh", for instance "$FTSTA,1,RUN,0*hh". The mode may be empty.
struct RigState {
  bool armed{false};
  std::string mode;
  bool failsafe{false};
};

/// From the rig: "$FTAPP,1500,1618,...*hh" or "$FTAPF,3.250,...*hh" (applied), "$FTBAT,16.2*hh" (V); of one that tells
/// how it is, "$FTSTA" once a second at least and "$FTMSG,severity,text*hh" for people (severities as MAVLink's).
class ThrusterText final : public NmeaParser {
 public:
  explicit ThrusterText(const Settings& settings);
  /// Of the latest sentence; nothing when it was another.
  [[nodiscard]] const std::optional<RigState>& state() const { return state_; }
  [[nodiscard]] const std::optional<VehicleText>& words() const { return text_; }

 private:
  void sentence(const Words& words, Frame& frame) override;
  void describe_values(Fields& fields) const override;

  std::optional<double> voltage_;
  std::optional<RigState> state_;
  std::optional<VehicleText> text_;
  Battery battery_;
  Thrusters pulses_, forces_;
};

}  // namespace fathom::devices

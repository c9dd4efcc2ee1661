// The vehicle behind a thruster driver, played: what it says of itself unasked, and how it can be out of order.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/samples/sensors.hpp"
#include "common/samples/vehicle_condition.hpp"

namespace fathom::devices {

/// As it comes: armed, in the mode that obeys, well.
struct EmulatedVehicle {
  bool armed{true};
  std::string mode{"MANUAL"};
  bool heartbeat{true};
  bool failsafe{false};
  bool obeys{true};                  ///< false: its outputs stay neutral although all else is well
  bool tells{true};                  ///< of a rig: false is one of before $FTSTA
  std::optional<double> voltage{};   ///< V; none: that of the moment
  std::vector<VehicleText> words{};  ///< said with the next report, once

  [[nodiscard]] bool turns() const { return armed && obeys; }
};

/// Changes it by a word: armed, disarmed, mode=STABILIZE, heartbeat=off, failsafe=on, obeys=off, tells=off,
/// voltage=9.0, says=2,Leak Detected (severity, text). InputError for anything else.
void play(EmulatedVehicle& vehicle, std::string_view word);

/// "5:disarmed" is played 5 s after the start.
struct PlayedCondition {
  double time{};  ///< s
  std::string word;
  /// InputError for what is neither, with the words that are known.
  [[nodiscard]] static PlayedCondition parse(const std::string& text);
};

/// What ArduSub says unasked: HEARTBEAT, SERVO_OUTPUT_RAW, SYS_STATUS and STATUSTEXT. `time` [s] since 1970.
[[nodiscard]] std::string mavlink_packets(const EmulatedVehicle& vehicle, const Thrusters& applied, double voltage,
                                          double time);
/// What a rig answers: $FTSTA, $FTMSG, $FTBAT and $FTAPP or $FTAPF.
[[nodiscard]] std::string rig_sentences(const EmulatedVehicle& vehicle, const Thrusters& applied, double voltage);

}  // namespace fathom::devices

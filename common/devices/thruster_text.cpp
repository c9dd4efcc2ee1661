#include "common/devices/thruster_text.hpp"

#include <utility>

#include "common/devices/emulation/emulation.hpp"

namespace fathom::devices {

std::string thruster_sentence(std::span<const double> pwm_us) {
  std::string body = "FTPWM";
  for (const double each : pwm_us) body += detail::format(",%.0f", each);
  return detail::nmea_sentence(body);
}

std::string force_sentence(std::span<const double> force) {
  std::string body = "FTFRC";
  for (const double each : force) body += detail::format(",%.3f", each);
  return detail::nmea_sentence(body);
}

ThrusterText::ThrusterText(const Settings& settings) : NmeaParser{true} {
  pulses_.pwm_us.resize(settings.motors);
  forces_.force.resize(settings.motors);
}

void ThrusterText::sentence(const Words& words, Frame& frame) {
  voltage_.reset();
  state_.reset();
  text_.reset();
  if (words[0] == "FTBAT") {
    voltage_ = words.number_at(1);
    if (!voltage_) return;
    battery_ = Battery{.voltage = *voltage_};
    frame.sample = &battery_;
  } else if (words[0] == "FTSTA") {
    const bool known = (words[1] == "0" || words[1] == "1") && (words[3] == "0" || words[3] == "1" || words[3].empty());
    if (!known) {
      complain("the rig's state is not $FTSTA,0|1,MODE,0|1");
      return;
    }
    state_ = RigState{.armed = words[1] == "1", .mode = std::string{words[2]}, .failsafe = words[3] == "1"};
  } else if (words[0] == "FTMSG") {
    const auto severity = whole(words[1]);
    if (!severity || *severity > 7) return;
    std::string text{words[2]};  // a comma in it is not the end
    for (std::size_t i = 3; i < words.size(); ++i) text += "," + std::string{words[i]};
    text_ = VehicleText{.severity = static_cast<int>(*severity), .text = std::move(text), .age = 0.0};
  } else if (words[0] == "FTAPP" || words[0] == "FTAPF") {
    const bool pulses = words[0] == "FTAPP";
    std::vector<double>& applied = pulses ? pulses_.pwm_us : forces_.force;
    if (words.size() != applied.size() + 1) {
      complain("the rig reports another number of thrusters than the vehicle file has");
      return;
    }
    for (std::size_t i = 0; i < applied.size(); ++i) {
      const auto value = words.number_at(i + 1);
      if (!value || (pulses && *value <= 0.0)) return;
      applied[i] = *value;
    }
    frame.sample = pulses ? &pulses_ : &forces_;
  }
}

void ThrusterText::describe_values(Fields& fields) const { fields.add("voltage_v", voltage_); }

}  // namespace fathom::devices

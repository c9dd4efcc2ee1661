#include "common/devices/thruster_text.hpp"

#include "common/devices/emulation.hpp"

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
  if (words[0] == "FTBAT") {
    voltage_ = words.number_at(1);
    if (!voltage_) return;
    battery_ = Battery{.voltage = *voltage_};
    frame.sample = &battery_;
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

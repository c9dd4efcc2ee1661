#include "common/devices/thruster_text.hpp"

#include "common/devices/emulation.hpp"

namespace fathom::devices {

std::string thruster_sentence(std::span<const double> pwm_us) {
  std::string body = "FTPWM";
  for (const double each : pwm_us) body += detail::format(",%.0f", each);
  return detail::nmea_sentence(body);
}

ThrusterText::ThrusterText(const Settings& settings) : NmeaParser{true} { thrusters_.pwm_us.resize(settings.motors); }

void ThrusterText::sentence(const Words& words, Frame& frame) {
  voltage_.reset();
  if (words[0] == "FTBAT") {
    voltage_ = words.number_at(1);
    if (!voltage_) return;
    battery_ = Battery{.voltage = *voltage_};
    frame.sample = &battery_;
  } else if (words[0] == "FTAPP") {
    if (words.size() != thrusters_.pwm_us.size() + 1) {
      complain("the rig reports another number of thrusters than the vehicle file has");
      return;
    }
    for (std::size_t i = 0; i < thrusters_.pwm_us.size(); ++i) {
      const auto pwm = words.number_at(i + 1);
      if (!pwm || *pwm <= 0.0) return;
      thrusters_.pwm_us[i] = *pwm;
    }
    frame.sample = &thrusters_;
  }
}

void ThrusterText::describe_values(Fields& fields) const { fields.add("voltage_v", voltage_); }

}  // namespace fathom::devices

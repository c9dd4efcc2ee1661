#include "common/devices/emulation/emulated_vehicle.hpp"

#include <cmath>
#include <cstdint>

#include "common/base/error.hpp"
#include "common/devices/ardusub_modes.hpp"
#include "common/devices/checksum.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/text.hpp"

namespace fathom::devices {
namespace {

using detail::format;
using detail::FrameWriter;
using detail::nmea_sentence;

constexpr char kKnown[] =
    "armed, disarmed, mode=NAME, heartbeat=on|off, failsafe=on|off, obeys=on|off, tells=on|off, voltage=V, "
    "says=SEVERITY,TEXT";

[[noreturn]] void unknown(std::string_view word) {
  throw InputError("no condition '" + std::string{word} + "' can be played; known: " + kKnown);
}

bool switched(std::string_view word, std::string_view value) {
  if (value != "on" && value != "off") unknown(word);
  return value == "on";
}

std::string packet(std::uint8_t id, std::uint8_t crc_extra, const std::string& payload) {
  FrameWriter body;
  body.little(static_cast<std::uint8_t>(payload.size()));
  body.text += std::string("\0\0\0\1\1", 5);
  body.little(id);
  body.zeros(2);
  body.text += payload;
  const std::string checked = body.text + static_cast<char>(crc_extra);
  body.little(crc16_reflected(as_bytes(checked), 0xFFFF));
  return "\xFD" + body.text;
}

std::string status_text(const VehicleText& words) {
  constexpr std::size_t kMost = 50;
  std::string payload(1, static_cast<char>(words.severity));
  payload += words.text.substr(0, kMost);
  return packet(253, 83, payload);
}

}  // namespace

void play(EmulatedVehicle& vehicle, std::string_view word) {
  const std::size_t equals = word.find('=');
  const std::string_view name = word.substr(0, equals);
  const std::string_view value = equals == std::string_view::npos ? "" : word.substr(equals + 1);
  if (word == "armed" || word == "disarmed") {
    vehicle.armed = word == "armed";
  } else if (name == "mode" && ardusub_mode(value)) {
    vehicle.mode = value;
  } else if (name == "heartbeat") {
    vehicle.heartbeat = switched(word, value);
  } else if (name == "failsafe") {
    vehicle.failsafe = switched(word, value);
  } else if (name == "obeys") {
    vehicle.obeys = switched(word, value);
  } else if (name == "tells") {
    vehicle.tells = switched(word, value);
  } else if (name == "voltage" && number(value)) {
    vehicle.voltage = *number(value);
  } else if (name == "says") {
    const std::size_t comma = value.find(',');
    const auto severity = number(value.substr(0, comma));
    if (comma == std::string_view::npos || !severity || *severity < 0.0 || *severity > 7.0) unknown(word);
    vehicle.words.push_back(
        {.severity = static_cast<int>(*severity), .text = std::string{value.substr(comma + 1)}, .age = 0.0});
  } else {
    unknown(word);
  }
}

PlayedCondition PlayedCondition::parse(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto time = number(std::string_view{text}.substr(0, colon));
  if (colon == std::string::npos || !time || !(*time >= 0.0)) {
    throw InputError("'" + text + "': write TIME:CONDITION, for instance 5:disarmed; known: " + kKnown);
  }
  PlayedCondition condition{.time = *time, .word = text.substr(colon + 1)};
  EmulatedVehicle tried;
  play(tried, condition.word);
  return condition;
}

std::string mavlink_packets(const EmulatedVehicle& vehicle, const Thrusters& applied, double voltage, double time) {
  constexpr std::uint8_t kManualInput = 0x40, kArmed = 0x80;        // base mode
  constexpr std::uint8_t kStandby = 3, kActive = 4, kCritical = 5;  // state
  std::string packets;
  if (vehicle.heartbeat) {
    FrameWriter heartbeat;
    heartbeat.little(*ardusub_mode(vehicle.mode));
    heartbeat.text += std::string("\x0C\x03", 2);  // submarine, ArduPilot
    heartbeat.little(static_cast<std::uint8_t>(kManualInput | (vehicle.armed ? kArmed : 0)));
    heartbeat.little(vehicle.failsafe ? kCritical : vehicle.armed ? kActive : kStandby);
    heartbeat.little(std::uint8_t{3});
    packets += packet(0, 50, heartbeat.text);
  }
  FrameWriter servo;
  servo.little(static_cast<std::uint32_t>(static_cast<std::uint64_t>(time * 1e6) & 0xFFFFFFFFU));
  for (std::size_t k = 0; k < 8; ++k) {
    const double pwm = vehicle.turns() && k < applied.pwm_us.size() ? applied.pwm_us[k] : 1500.0;
    servo.little(static_cast<std::uint16_t>(std::lround(pwm)));
  }
  servo.little(std::uint8_t{1});
  packets += packet(36, 222, servo.text);
  if (const double told = vehicle.voltage.value_or(voltage); told > 0.0) {
    FrameWriter status;
    status.zeros(14);
    status.little(static_cast<std::uint16_t>(std::lround(1e3 * told)));  // mV
    status.zeros(14);
    status.little(std::int8_t{80});
    packets += packet(1, 124, status.text);
  }
  for (const VehicleText& words : vehicle.words) packets += status_text(words);
  return packets;
}

std::string rig_sentences(const EmulatedVehicle& vehicle, const Thrusters& applied, double voltage) {
  std::string sentences;
  if (vehicle.tells && vehicle.heartbeat) {
    sentences += nmea_sentence(std::string{"FTSTA,"} + (vehicle.armed ? "1," : "0,") + vehicle.mode +
                               (vehicle.failsafe ? ",1" : ",0"));
  }
  for (const VehicleText& words : vehicle.words) {
    sentences += nmea_sentence("FTMSG," + std::to_string(words.severity) + "," + words.text);
  }
  const double told = vehicle.voltage.value_or(voltage);
  if (told > 0.0) sentences += nmea_sentence(format("FTBAT,%.2f", told));
  std::string line = applied.pwm_us.empty() ? "FTAPF" : "FTAPP";
  for (const double pwm : applied.pwm_us) line += format(",%.0f", vehicle.turns() ? pwm : 1500.0);
  for (std::size_t i = 0; applied.pwm_us.empty() && i < applied.force.size(); ++i) {
    line += format(",%.3f", vehicle.turns() ? applied.force[i] : 0.0);
  }
  return sentences + nmea_sentence(line);
}

}  // namespace fathom::devices

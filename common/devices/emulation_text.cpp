// Acoustic positions and ranges, depth and loads: text lines from samples.
#include <cmath>

#include "common/devices/checksum.hpp"
#include "common/devices/emulation.hpp"

namespace fathom::devices::detail {
namespace {

std::string day_time(double time) {
  const double day = std::fmod(time, 86400.0);
  const int minutes = static_cast<int>(day / 60.0);
  return format("%02d%02d%06.3f", minutes / 60, minutes % 60, day - 60.0 * minutes);
}

double no_zero(double value) { return std::abs(value) < 5e-4 ? 0.0 : value; }

std::string psimssb(const Instant& now, const Settings& settings) {
  const Eigen::Vector3d p = now.usbl.p_WB - settings.transceiver.p_W;
  const std::string& beacon = settings.transceiver.beacon;
  return nmea_sentence("PSIMSSB," + day_time(now.time) + "," + (beacon.empty() ? "B01" : beacon) +
                       format(",%c,,C,N,M,%.3f,%.3f,%.3f,%.3f,N,,", now.usbl.valid ? 'A' : 'V', no_zero(p.x()),
                              no_zero(p.y()), p.z(), now.usbl.sigma.x() * std::sqrt(2.0)));
}

std::string evologics(const Instant& now, const Settings& settings) {
  const Eigen::Vector3d p = now.usbl.p_WB - settings.transceiver.p_W;
  const std::string& beacon = settings.transceiver.beacon;
  const std::string text = format("USBLLONG,%.6f,%.6f,%s,0,0,0,%.4f,%.4f,%.4f,0,0,0,%d,-40,120,%.4f", now.time + 0.4,
                                  now.time, beacon.empty() ? "2" : beacon.c_str(), p.y(), p.x(), -p.z(),
                                  static_cast<int>(p.norm() / 1500.0 * 1e6), now.usbl.sigma.x());
  return "+++AT:" + std::to_string(text.size()) + ":" + text + "\r\n";
}

std::string psimlbm(const Instant& now) {
  std::string text = "PSIMLBM," + day_time(now.time) + ",1,1,0.0,0.0,0.0," + format("%.2f", now.depth.z);
  for (std::size_t i = 0; i < 8; ++i) {
    const bool valid = i < now.ranges.range.size() && now.ranges.valid[i] != 0;
    text += valid ? format(",%.3f", now.ranges.range[i]) : ",";
  }
  return nmea_sentence(text + ",M");
}

std::string range_text(const Instant& now, const Settings& settings) {
  std::string text;
  for (std::size_t i = 0; i < now.ranges.range.size(); ++i) {
    const std::string name = i < settings.transponders.size() ? settings.transponders[i] : "r" + std::to_string(i + 1);
    text +=
        (text.empty() ? "" : " ") + name + "=" + (now.ranges.valid[i] != 0 ? format("%.3f", now.ranges.range[i]) : "");
  }
  return text + "\r\n";
}

std::string load_text(const Instant& now, const Settings& settings) {
  std::string text;
  for (std::size_t i = 0; i < now.loads.load.size(); ++i) {
    const LoadCell cell = i < settings.cells.size() ? settings.cells[i] : LoadCell{};
    text += (text.empty() ? "" : " ") + format("%+010.4f", now.loads.load[i] / cell.gain + cell.zero);
    if (!cell.unit.empty()) text += " " + cell.unit;
  }
  return text + "\r\n";
}

// What ArduSub says unasked: HEARTBEAT, SERVO_OUTPUT_RAW and SYS_STATUS.
std::string mavlink_packets(const Instant& now) {
  const auto packet = [](std::uint8_t id, std::uint8_t crc_extra, const std::string& payload) {
    FrameWriter body;
    body.little(static_cast<std::uint8_t>(payload.size()));
    body.text += std::string("\0\0\0\1\1", 5);
    body.little(id);
    body.zeros(2);
    body.text += payload;
    const std::string checked = body.text + static_cast<char>(crc_extra);
    body.little(crc16_reflected(as_bytes(checked), 0xFFFF));
    return "\xFD" + body.text;
  };
  FrameWriter heartbeat;
  heartbeat.little(std::uint32_t{19});                       // manual mode
  heartbeat.text += std::string("\x0C\x03\x40\x04\x03", 5);  // submarine, ArduPilot, manual input, active
  FrameWriter servo;
  servo.little(static_cast<std::uint32_t>(static_cast<std::uint64_t>(now.time * 1e6) & 0xFFFFFFFFU));
  for (int i = 0; i < 8; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double pwm = k < now.thrusters.pwm_us.size() ? now.thrusters.pwm_us[k] : 1500.0;
    servo.little(static_cast<std::uint16_t>(std::lround(pwm)));
  }
  servo.little(std::uint8_t{1});
  FrameWriter status;
  status.zeros(14);
  status.little(static_cast<std::uint16_t>(std::lround(1e3 * now.voltage)));  // mV
  status.zeros(14);
  status.little(std::int8_t{80});
  return packet(0, 50, heartbeat.text) + packet(36, 222, servo.text) +
         (now.voltage > 0.0 ? packet(1, 124, status.text) : "");
}

std::string rig_sentences(const Instant& now) {
  const Thrusters& told = now.thrusters;
  std::string applied = told.pwm_us.empty() ? "FTAPF" : "FTAPP";
  for (const double pwm : told.pwm_us) applied += format(",%.0f", pwm);
  for (std::size_t i = 0; told.pwm_us.empty() && i < told.force.size(); ++i) applied += format(",%.3f", told.force[i]);
  return (now.voltage > 0.0 ? nmea_sentence(format("FTBAT,%.2f", now.voltage)) : "") + nmea_sentence(applied);
}

}  // namespace

std::string emulate_text(std::string_view protocol, const Instant& now, const Settings& settings) {
  if (protocol == "nmea_usbl") return psimssb(now, settings);
  if (protocol == "evologics") return evologics(now, settings);
  if (protocol == "psimlbm") return psimlbm(now);
  if (protocol == "range_text") return range_text(now, settings);
  if (protocol == "load_text") return load_text(now, settings);
  if (protocol == "mavlink") return mavlink_packets(now);
  if (protocol == "thruster_text") return rig_sentences(now);
  return nmea_sentence(format("SDDPT,%.3f,0.00", now.depth.z));
}

}  // namespace fathom::devices::detail

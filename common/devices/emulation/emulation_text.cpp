// Acoustic positions and ranges, depth and loads: text lines from samples.
#include <cmath>
#include <cstdlib>

#include "common/base/spatial.hpp"
#include "common/devices/checksum.hpp"
#include "common/devices/emulation/emulation.hpp"

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

// An enhanced answer to a ping, in decimetres: the depth is the beacon's own.
std::string seatrac(const Instant& now, const Settings& settings) {
  const Transceiver& from = settings.transceiver;
  const Eigen::Vector3d p = rotation_from_euler({0.0, 0.0, -from.declination}) * (now.usbl.p_WB - from.p_W);
  const auto tenths = [](double value) { return static_cast<std::int16_t>(std::lround(10.0 * value)); };
  FrameWriter message;
  message.text = "\x42\x0F";
  message.text += static_cast<char>(from.beacon.empty() ? 2 : std::atoi(from.beacon.c_str()));
  message.text += static_cast<char>(now.usbl.valid ? 0x0F : 0x1F);
  message.text += '\x07';
  for (const int each : {0, 0, 0, 10, 15000, -400}) message.little(static_cast<std::int16_t>(each));
  const double distance = p.norm();
  message.little(static_cast<std::uint32_t>(std::lround(distance / 1500.0 * 2.0 * 16000.0)));
  message.little(static_cast<std::uint32_t>(std::lround(distance / 1500.0 * 1e7)));
  message.little(static_cast<std::uint16_t>(std::lround(10.0 * distance)));
  message.text += '\x04';
  message.zeros(8 + 6);
  for (const double each : {p.y(), p.x(), now.usbl.p_WB.z()}) message.little(tenths(each));
  message.little(crc16_arc(as_bytes(message.text)));
  std::string line = "$";
  for (const char c : message.text) line += format("%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
  return line + "\r\n";
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

}  // namespace

std::string emulate_text(std::string_view protocol, const Instant& now, const Settings& settings) {
  if (protocol == "nmea_usbl") return psimssb(now, settings);
  if (protocol == "evologics") return evologics(now, settings);
  if (protocol == "seatrac") return seatrac(now, settings);
  if (protocol == "psimlbm") return psimlbm(now);
  if (protocol == "range_text") return range_text(now, settings);
  if (protocol == "load_text") return load_text(now, settings);
  if (protocol == "mavlink") return mavlink_packets(now.vehicle, now.thrusters, now.voltage, now.time);
  if (protocol == "thruster_text") return rig_sentences(now.vehicle, now.thrusters, now.voltage);
  return nmea_sentence(format("SDDPT,%.3f,0.00", now.depth.z));
}

}  // namespace fathom::devices::detail

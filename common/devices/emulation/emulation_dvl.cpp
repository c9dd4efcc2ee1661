// Velocity logs' bytes from samples.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/base/spatial.hpp"
#include "common/devices/attitude.hpp"
#include "common/devices/checksum.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/velocity/nortek_ad2cp.hpp"

namespace fathom::devices {

// A beam hears how fast its patch of bottom comes nearer to a standing instrument: minus the bottom's velocity along
// the beam, and the bottom moves with minus the vehicle's velocity.
std::array<double, 4> emulated_beam_velocities(const Eigen::Vector3d& v_BS_S, double beam_angle) {
  const double s = std::sin(beam_angle);
  const double c = std::cos(beam_angle);
  const std::array<Eigen::Vector3d, 4> out{Eigen::Vector3d{0, -s, c}, Eigen::Vector3d{0, s, c},
                                           Eigen::Vector3d{s, 0, c}, Eigen::Vector3d{-s, 0, c}};
  std::array<double, 4> toward{};
  for (std::size_t i = 0; i < 4; ++i) toward[i] = v_BS_S.dot(out[i]);
  return toward;
}

namespace detail {
namespace {

constexpr std::int16_t kBad = -32768;

std::int16_t millimetres(double value) { return static_cast<std::int16_t>(std::lround(1e3 * value)); }

struct Clock {
  int year{}, month{}, day{}, hour{}, minute{}, second{}, hundredth{};
};

Clock clock_of(double time) {
  using namespace std::chrono;
  const auto hundredths = static_cast<std::int64_t>(std::floor(time * 100.0 + 0.5));
  const sys_days date{days{hundredths / 8'640'000}};
  const year_month_day ymd{date};
  const int rest = static_cast<int>(hundredths % 8'640'000);
  return {.year = static_cast<int>(ymd.year()),
          .month = static_cast<int>(static_cast<unsigned>(ymd.month())),
          .day = static_cast<int>(static_cast<unsigned>(ymd.day())),
          .hour = rest / 360'000,
          .minute = rest / 6'000 % 60,
          .second = rest / 100 % 60,
          .hundredth = rest % 100};
}

struct Told {
  std::array<double, 4> velocity{};  ///< m/s, of the vehicle, in Teledyne's order of axes
  Eigen::Vector3d euler;
};

// Velocity of the vehicle as the frame has it: starboard, forward, up or east, north, up or along the beams.
Told tell(const Instant& now, const EmulatedDvl& dvl) {
  const Eigen::Vector3d& v = now.dvl.v_WB_B;
  Told told{.velocity = {v.y(), v.x(), -v.z(), 0.0}, .euler = euler_from_rotation(now.ahrs.q_WB.toRotationMatrix())};
  if (dvl.frame == DvlFrame::kBeam) {
    told.velocity = emulated_beam_velocities(v, dvl.beam_angle_deg * kRadians);
    // Vehicle's sign: minus how the bottom comes nearer.
    for (double& each : told.velocity) each = -each;
  }
  if (dvl.frame == DvlFrame::kShip) {
    const Eigen::Vector3d level = rotation_from_euler({told.euler.x(), told.euler.y(), 0.0}) * v;
    told.velocity = {level.y(), level.x(), -level.z(), 0.0};
  }
  if (dvl.frame == DvlFrame::kEarth) {
    const Eigen::Vector3d ned = now.ahrs.q_WB * v;
    told.velocity = {ned.y(), ned.x(), -ned.z(), 0.0};
  }
  return told;
}

// Range of a beam along the instrument's axis above a flat bottom.
std::array<double, 4> axis_ranges(const Instant& now, double angle) {
  const double t = std::tan(angle);
  const Eigen::Matrix3d R_WB = now.ahrs.q_WB.toRotationMatrix();
  const std::array<Eigen::Vector3d, 4> beams{Eigen::Vector3d{0, -t, 1}, Eigen::Vector3d{0, t, 1},
                                             Eigen::Vector3d{t, 0, 1}, Eigen::Vector3d{-t, 0, 1}};
  std::array<double, 4> range{};
  for (std::size_t i = 0; i < 4; ++i) range[i] = now.dvl.altitude / (R_WB * beams[i]).z();
  return range;
}

// Tilts of pendulums: roll as it is, pitch against the vertical.
double pendulum_pitch(const Eigen::Vector3d& euler) { return std::atan(std::tan(euler.y()) / std::cos(euler.x())); }

std::uint16_t heading_hundredths(double heading) {
  const double degrees = heading / kRadians;
  return static_cast<std::uint16_t>(std::lround(100.0 * (degrees < 0.0 ? degrees + 360.0 : degrees)) % 36000);
}

std::string pd0_frame(const Instant& now, const EmulatedDvl& dvl) {
  const Told told = tell(now, dvl);
  const Clock clock = clock_of(now.time);
  const auto hundredths = [](double angle) { return static_cast<std::int16_t>(std::lround(100.0 * angle / kRadians)); };
  FrameWriter fixed;
  fixed.little(std::uint16_t{0x0000});
  fixed.text += "\x33\x29";
  const unsigned angle_bits = dvl.beam_angle_deg < 17.0 ? 0U : dvl.beam_angle_deg < 25.0 ? 1U : 2U;
  fixed.little(static_cast<std::uint16_t>(0x404B | angle_bits << 8));
  fixed.zeros(2);
  fixed.text += '\x04';
  fixed.zeros(25 - fixed.text.size());
  fixed.text += static_cast<char>(static_cast<unsigned>(dvl.frame) << 3 | 6U);
  fixed.zeros(58 - fixed.text.size());
  FrameWriter variable;
  variable.little(std::uint16_t{0x0080});
  variable.little(std::uint16_t{1});
  for (const int each :
       {clock.year - 2000, clock.month, clock.day, clock.hour, clock.minute, clock.second, clock.hundredth}) {
    variable.text += static_cast<char>(each);
  }
  variable.zeros(14 - variable.text.size());
  variable.little(std::uint16_t{1500});
  variable.little(std::uint16_t{0});
  variable.little(heading_hundredths(told.euler.z()));
  variable.little(hundredths(pendulum_pitch(told.euler)));
  variable.little(hundredths(told.euler.x()));
  variable.zeros(58 - variable.text.size());
  FrameWriter bottom;
  bottom.little(std::uint16_t{0x0600});
  bottom.zeros(14);
  const auto ranges = axis_ranges(now, dvl.beam_angle_deg * kRadians);
  const auto lost = [&](std::size_t i) { return !now.dvl.valid || static_cast<int>(i) == dvl.bad_beam; };
  for (std::size_t i = 0; i < 4; ++i) {
    bottom.little(static_cast<std::uint16_t>(lost(i) ? 0 : std::lround(100.0 * ranges[i])));
  }
  for (std::size_t i = 0; i < 4; ++i) {  // PD0: the bottom moves
    const bool bad = !now.dvl.valid || (dvl.frame == DvlFrame::kBeam && lost(i));
    bottom.little(bad ? kBad : millimetres(-told.velocity[i]));
  }
  bottom.zeros(81 - bottom.text.size());
  FrameWriter frame;
  const std::size_t header = 6 + 2 * 3;
  frame.text = "\x7F\x7F";
  const std::size_t size = header + fixed.text.size() + variable.text.size() + bottom.text.size();
  frame.little(static_cast<std::uint16_t>(size));
  frame.zeros(1);
  frame.text += '\x03';
  frame.little(static_cast<std::uint16_t>(header));
  frame.little(static_cast<std::uint16_t>(header + fixed.text.size()));
  frame.little(static_cast<std::uint16_t>(header + fixed.text.size() + variable.text.size()));
  frame.text += fixed.text + variable.text + bottom.text;
  frame.little(sum16(as_bytes(frame.text)));
  return frame.text;
}

// PD5: with attitude.
std::string pd5_frame(const Instant& now, const EmulatedDvl& dvl) {
  const Told told = tell(now, dvl);
  const Clock clock = clock_of(now.time);
  FrameWriter frame;
  frame.text = "\x7D\x01";
  frame.little(std::uint16_t{86});
  frame.text += static_cast<char>(static_cast<unsigned>(dvl.frame) << 6 | 0x23U);
  for (const double v : told.velocity) frame.little(now.dvl.valid ? millimetres(v) : kBad);
  for (const double range : axis_ranges(now, dvl.beam_angle_deg * kRadians)) {
    frame.little(static_cast<std::uint16_t>(now.dvl.valid ? std::lround(100.0 * range) : 0));
  }
  frame.text += now.dvl.valid ? '\0' : '\x01';
  for (int i = 0; i < 4; ++i) frame.little(kBad);
  frame.zeros(5);
  for (const int each : {clock.hour, clock.minute, clock.second, clock.hundredth}) {
    frame.text += static_cast<char>(each);
  }
  frame.zeros(2);
  frame.little(std::uint16_t{1500});
  frame.little(std::int16_t{1500});
  frame.text += '\x23';
  frame.little(std::uint16_t{0});
  frame.little(static_cast<std::int16_t>(std::lround(100.0 * told.euler.y() / kRadians)));
  frame.little(static_cast<std::int16_t>(std::lround(100.0 * told.euler.x() / kRadians)));
  frame.little(heading_hundredths(told.euler.z()));
  frame.zeros(32);
  frame.little(sum16(as_bytes(frame.text)));
  return frame.text;
}

// As an instrument that was told how it is mounted (EA): tilts and ":BS" are the vehicle's, ":BI" its own.
std::string pd6_lines(const Instant& now, const Settings& settings) {
  const Eigen::Matrix3d R_WB = now.ahrs.q_WB.toRotationMatrix() * settings.R_BS.transpose();
  const Eigen::Vector3d radians = euler_from_rotation(R_WB), euler = radians / kRadians;
  const Clock clock = clock_of(now.time);
  const double heading = euler.z() < 0.0 ? euler.z() + 360.0 : euler.z();
  std::string text = format(":SA,%+6.2f,%+6.2f,%6.2f\r\n", euler.y(), euler.x(), heading);
  text += format(":TS,%02d%02d%02d%02d%02d%02d%02d,35.0,+15.0,%5.1f,1500.0,  0\r\n", clock.year % 100, clock.month,
                 clock.day, clock.hour, clock.minute, clock.second, clock.hundredth, std::max(0.0, now.depth.z));
  const Eigen::Vector3d v = 1e3 * now.dvl.v_WB_B;
  const Eigen::Vector3d vehicle = settings.R_BS * v;
  const Eigen::Vector3d ship =
      settings.ship_is_level ? rotation_from_euler({radians.x(), radians.y(), 0.0}) * vehicle : vehicle;
  const char status = now.dvl.valid ? 'A' : 'V';
  if (settings.water_linked_axes) {
    text += format(":BI,%+6.0f,%+6.0f,%+6.0f,    +0,%c\r\n", v.x(), v.y(), v.z(), status);
  } else {
    text += format(":BI,%+6.0f,%+6.0f,%+6.0f,    +0,%c\r\n", v.y(), v.x(), -v.z(), status);
  }
  text += format(":BS,%+6.0f,%+6.0f,%+6.0f,%c\r\n", ship.y(), ship.x(),
                 settings.water_linked_axes ? ship.z() : -ship.z(), status);
  text += format(":BE,    +0,    +0,    +0,V\r\n:BD,+0.00,+0.00,+0.00,%7.2f, 0.00\r\n", now.dvl.altitude);
  return text;
}

std::string wl_serial_lines(const Instant& now) {
  const Eigen::Vector3d& v = now.dvl.v_WB_B;
  const auto us = static_cast<long long>(std::llround(now.time * 1e6));
  const std::string body =
      format("wrz,%.3f,%.3f,%.3f,%c,%.2f,0.005,1e-05;0;0;0;1e-05;0;0;0;1e-05,%lld,%lld,125.00,0", v.x(), v.y(), v.z(),
             now.dvl.valid ? 'y' : 'n', now.dvl.altitude > 0.0 ? now.dvl.altitude : -1.0, us, us + 2000);
  return body + format("*%02x\r\n", static_cast<unsigned>(crc8(as_bytes(body))));
}

std::string wl_json_line(const Instant& now) {
  const Eigen::Vector3d& v = now.dvl.v_WB_B;
  const auto us = static_cast<long long>(std::llround(now.time * 1e6));
  const char* valid = now.dvl.valid ? "true" : "false";
  std::string beams;
  for (int i = 0; i < 4; ++i) {
    beams += format("%s{\"id\":%d,\"velocity\":%.5f,\"distance\":%.2f,\"rssi\":-40,\"nsd\":-95,\"beam_valid\":%s}",
                    i > 0 ? "," : "", i, v.z(), now.dvl.altitude, valid);
  }
  return format(
             "{\"time\":125.0,\"vx\":%.6f,\"vy\":%.6f,\"vz\":%.6f,\"fom\":0.005,\"covariance\":[[1e-05,0,0],[0,1e-05,"
             "0],[0,0,1e-05]],\"altitude\":%.3f,\"transducers\":[",
             v.x(), v.y(), v.z(), now.dvl.altitude > 0.0 ? now.dvl.altitude : -1.0) +
         beams +
         format(
             "],\"velocity_valid\":%s,\"status\":0,\"time_of_validity\":%lld,\"time_of_transmission\":%lld,"
             "\"format\":\"json_v3.1\",\"type\":\"velocity\"}\r\n",
             valid, us, us + 2000);
}

// Of a Nortek log with four beams: X, Y, Z as they are, or none.
constexpr double kNortekNoVelocity = -32.768, kNortekNoMerit = 10.0;  // m/s
constexpr std::uint32_t kNortekAllValid = 0x000FFFFF;

std::string nortek_text_line(const Instant& now) {
  const Eigen::Vector3d v =
      now.dvl.valid ? now.dvl.v_WB_B : Eigen::Vector3d{Eigen::Vector3d::Constant(kNortekNoVelocity)};
  const double d = now.dvl.altitude;
  return nmea_sentence(
      format("PNORBT9,%.4f,-100.000,-120.000,%.5f,%.5f,%.5f,%.5f,%.2f,%.2f,%.2f,%.2f,15.9,1500.0,1.30,15.00,0x%08X",
             now.time, v.x(), v.y(), v.z(), now.dvl.valid ? 0.005 : kNortekNoMerit, d, d, d, d,
             static_cast<unsigned>(now.dvl.valid ? kNortekAllValid : 0U)));
}

std::string nortek_ad2cp_record(const Instant& now) {
  const Clock clock = clock_of(std::floor(now.time));
  FrameWriter data;
  data.text = "\x01\x24";
  data.little(std::uint32_t{100001});
  for (const int each : {clock.year - 1900, clock.month - 1, clock.day, clock.hour, clock.minute, clock.second}) {
    data.text += static_cast<char>(each);
  }
  data.little(static_cast<std::uint16_t>(std::min(9999L, std::lround(1e4 * (now.time - std::floor(now.time))))));
  data.little(std::uint16_t{4});
  data.little(std::uint32_t{0});
  data.little(now.dvl.valid ? kNortekAllValid : std::uint32_t{0});
  const auto reals = [&](const std::array<double, 4>& values) {
    for (const double each : values) data.little(static_cast<float>(each));
  };
  for (const float each : {1500.0F, 15.0F, 1.3F}) data.little(each);
  const double d = now.dvl.altitude, fom = now.dvl.valid ? 0.005 : kNortekNoMerit;
  reals({0.0, 0.0, 0.0, 0.0});
  reals({d, d, d, d});
  reals({fom, fom, fom, fom});
  data.zeros(48);
  const Eigen::Vector3d v =
      now.dvl.valid ? now.dvl.v_WB_B : Eigen::Vector3d{Eigen::Vector3d::Constant(kNortekNoVelocity)};
  reals({v.x(), v.y(), v.z(), v.z()});
  reals({fom, fom, fom, fom});
  data.zeros(48);
  FrameWriter header;
  header.text = "\xA5\x0A\x1B\x10";
  header.little(static_cast<std::uint16_t>(data.text.size()));
  header.little(nortek_checksum(as_bytes(data.text)));
  header.little(nortek_checksum(as_bytes(header.text)));
  return header.text + data.text;
}

// Eight times a second, so that the middle of the interval is now.
std::string cerulean_line(const Instant& now) {
  constexpr double kInterval = 0.125;  // s
  const Eigen::Vector3d d = kInterval * now.dvl.v_WB_B;
  return nmea_sentence(format("DVPDX,%lld,%lld,0.000000,0.000000,0.000000,%.6f,%.6f,%.6f,%d,1,0.00,0.00,%.3f",
                              static_cast<long long>(std::llround(1e6 * (now.time + 0.5 * kInterval))),
                              static_cast<long long>(std::llround(1e6 * kInterval)), d.x(), d.y(), d.z(),
                              now.dvl.valid ? 95 : 0, now.dvl.altitude));
}

}  // namespace

std::string emulate_dvl(std::string_view protocol, const Instant& now, const Settings& settings,
                        const EmulatedDvl& dvl) {
  if (protocol == "pd0") return pd0_frame(now, dvl);
  if (protocol == "pd4") return pd5_frame(now, dvl);
  if (protocol == "pd6") return pd6_lines(now, settings);
  if (protocol == "nortek_text") return nortek_text_line(now);
  if (protocol == "nortek_ad2cp") return nortek_ad2cp_record(now);
  if (protocol == "cerulean") return cerulean_line(now);
  if (protocol == "wl_serial") return wl_serial_lines(now);
  return wl_json_line(now);
}

}  // namespace detail
}  // namespace fathom::devices

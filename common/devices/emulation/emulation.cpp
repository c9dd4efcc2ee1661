#include "common/devices/emulation/emulation.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/devices/checksum.hpp"
#include "common/devices/protocols.hpp"

namespace fathom::devices {
namespace detail {

std::string format(const char* pattern, ...) {
  char text[1024];
  std::va_list arguments;
  va_start(arguments, pattern);
  const int length = std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return {text, static_cast<std::size_t>(length)};
}

std::string nmea_sentence(const std::string& body) {
  return "$" + body + format("*%02X\r\n", static_cast<unsigned>(xor8(as_bytes(body))));
}

}  // namespace detail

std::string emulate(std::string_view name, const Instant& now, const Settings& settings, const EmulatedDvl& dvl) {
  switch (protocol(name, "emulate").kind) {
    case Kind::kAhrs:
      return detail::emulate_ahrs(name, now, settings);
    case Kind::kDvl:
      return detail::emulate_dvl(name, now, settings, dvl);
    default:
      return detail::emulate_text(name, now, settings);
  }
}

double emulated_rate(std::string_view name) {
  switch (protocol(name, "emulate").kind) {
    case Kind::kAhrs:
      return name == "nmea_attitude" ? 10.0 : 100.0;
    case Kind::kDvl:
      return 8.0;
    case Kind::kUsbl:
    case Kind::kRanges:
      return 1.0;
    case Kind::kDepth:
    case Kind::kLoads:
    case Kind::kThrusters:
      return 10.0;
  }
  return 1.0;
}

Instant emulated_motion(double time, double since_start, const Settings& settings) {
  constexpr double kTurn = 0.1;      // rad/s
  constexpr double kSpeed = 0.5;     // m/s
  constexpr double kRock = 0.5;      // rad/s, of roll and pitch
  constexpr double kGravity = 9.81;  // m/s^2
  const double t = since_start;
  const Eigen::Vector3d euler{0.05 * std::sin(kRock * t), -0.03 * std::cos(kRock * t), wrap_angle(kTurn * t)};
  const Eigen::Matrix3d R_WB = rotation_from_euler(euler);
  const Eigen::Vector3d euler_dot{0.05 * kRock * std::cos(kRock * t), 0.03 * kRock * std::sin(kRock * t), kTurn};
  Instant now{.time = time};
  now.ahrs.q_WB = Eigen::Quaterniond{R_WB};
  // Small angles: roll and pitch rates are nearly body rates, and turning is about the vertical.
  now.ahrs.w_WB_B =
      Eigen::Vector3d{euler_dot.x(), euler_dot.y(), 0.0} + R_WB.transpose() * Eigen::Vector3d{0, 0, kTurn};
  now.ahrs.f_B = R_WB.transpose() * Eigen::Vector3d{0.0, 0.0, -kGravity};
  now.ahrs.has_rates = now.ahrs.has_specific_force = now.ahrs.has_attitude = true;
  now.dvl = Dvl{.v_WB_B = {kSpeed, 0.02 * std::sin(t), 0.01}, .altitude = 5.0 - 0.01 * std::fmod(t, 100.0)};
  now.usbl.p_WB = {kSpeed / kTurn * std::sin(kTurn * t), kSpeed / kTurn * (1.0 - std::cos(kTurn * t)), 3.0};
  now.usbl.sigma = Eigen::Vector3d::Constant(0.3);
  now.depth.z = 3.0 + 0.2 * std::sin(0.2 * t);
  const std::size_t ranges = settings.transponders.empty() ? 5 : settings.transponders.size();
  for (std::size_t i = 0; i < ranges; ++i) {
    const double angle = 2.0 * static_cast<double>(i);
    const Eigen::Vector3d beacon{20.0 * std::cos(angle), 20.0 * std::sin(angle), 10.0};
    now.ranges.range.push_back((beacon - now.usbl.p_WB).norm());
    now.ranges.valid.push_back(1);
  }
  now.thrusters.pwm_us.assign(settings.motors, 1500.0);
  const std::size_t cells = settings.cells.empty() ? 1 : settings.cells.size();
  for (std::size_t i = 0; i < cells; ++i) now.loads.load.push_back(10.0 + static_cast<double>(i) + std::sin(t));
  return now;
}

}  // namespace fathom::devices

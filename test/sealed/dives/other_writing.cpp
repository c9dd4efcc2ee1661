#include "test/sealed/dives/other_writing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <numbers>

namespace fathom::sealed {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::array<const char*, 6> kFreedoms{"surge", "sway", "heave", "roll", "pitch", "yaw"};

__attribute__((format(printf, 1, 2))) std::string text_of(const char* format, ...) {
  char buffer[512];
  va_list list;
  va_start(list, format);
  std::vsnprintf(buffer, sizeof buffer, format, list);
  va_end(list);
  return buffer;
}

std::string actuator(const Craft& craft, std::size_t i) {
  const Jet& jet = craft.jets[i];
  const Eigen::Vector3d& p = jet.position;
  const Eigen::Vector3d& a = jet.axis;
  const auto number = static_cast<int>(i) + 1;
  const std::string place = text_of("position: %.6f %.6f %.6f m", p[0], p[1], p[2]);
  const std::string axis = text_of("axis: %.0f %.0f %.0f", a[0], a[1], a[2]);
  switch (jet.drive) {
    case Drive::kForce:
      return text_of("  - {name: T%d, %s, %s}\n", number, place.c_str(), axis.c_str());
    case Drive::kPropeller:
      return text_of("  - {name: T%d, kind: propeller, %s, %s, diameter: %.6g m, K_T0: %.6g, K_TJ: %.6g}\n", number,
                     place.c_str(), axis.c_str(), jet.diameter, jet.thrust_0, jet.thrust_1);
    case Drive::kFin: {
      std::string behind;
      if (jet.behind >= 0) {
        behind = text_of(", behind: T%d, slipstream_diameter: %.6g m, slipstream_share: %.2f", jet.behind + 1,
                         jet.diameter, jet.share);
      }
      return text_of(
          "  - {name: T%d, kind: %s, %s, %s, area: %.6g m^2, lift_slope: %.6g 1/rad, stall: %.6g rad, "
          "reference_speed: %.1f m/s%s}\n",
          number, a.y() > 0.5 ? "rudder" : "fin", place.c_str(), axis.c_str(), jet.area, jet.slope, jet.stall,
          jet.reference, behind.c_str());
    }
    case Drive::kGained:
      return text_of("  - {name: T%d, kind: buoyancy_engine, %s}\n", number, place.c_str());
    case Drive::kMoved:
      return text_of("  - {name: T%d, kind: moving_mass, %s, mass: %.6g kg}\n", number, axis.c_str(), jet.moved_mass);
  }
  return {};
}

const char* unit_of(const Jet& jet) {
  switch (jet.drive) {
    case Drive::kForce:
      return "N";
    case Drive::kPropeller:
      return "rad/s";
    case Drive::kFin:
      return "rad";
    case Drive::kGained:
      return "m^3";
    case Drive::kMoved:
      return "m";
  }
  return "";
}

}  // namespace

double owners_density(const Craft& craft) { return craft.density < 1005.0 ? 998.0 : 1025.0; }

bool logs_commands(const Craft& craft) {
  return std::ranges::any_of(craft.jets, [](const Jet& jet) { return jet.drive != Drive::kForce; });
}

double command_of(const Craft& craft, const Jet& jet, double force) {
  const double density = owners_density(craft);
  switch (jet.drive) {
    case Drive::kForce:
      return force;
    case Drive::kPropeller: {
      const double square = density * std::pow(jet.diameter, 4) * jet.thrust_0;
      return std::copysign(kTurn * std::sqrt(std::abs(force) / square), force);
    }
    case Drive::kFin:
      return force / (0.5 * density * jet.area * jet.slope * jet.reference * jet.reference);
    case Drive::kGained:
      return -force / (density * kGravity);
    case Drive::kMoved:
      return force / (jet.moved_mass * kGravity);
  }
  return 0.0;
}

std::string other_keys(const Craft& craft) {
  std::string text = "dof: [";
  const char* comma = "";
  for (std::size_t i = 0; i < 6; ++i) {
    if (!craft.moves[i]) continue;
    text += std::string(comma) + kFreedoms[i];
    comma = ", ";
  }
  text += text_of("]\nhull: %.3f %.3f %.3f m\n", craft.extent[0], craft.extent[1], craft.extent[2]);
  if (craft.windage > 0.0) text += text_of("windage: %.3f m^2\n", craft.windage);
  text += logs_commands(craft) ? "actuators:\n" : "thrusters:\n";
  for (std::size_t i = 0; i < craft.jets.size(); ++i) text += actuator(craft, i);
  return text;
}

std::string to_map(const Craft& craft, bool voltage) {
  std::string columns, units;
  for (std::size_t i = 0; i < craft.jets.size(); ++i) {
    columns += (i > 0 ? ", c" : "c") + std::to_string(i + 1);
    units += (i > 0 ? ", " : "") + std::string(unit_of(craft.jets[i]));
  }
  return "source: a simulated trial\nlicence: none\ntime: {column: t, unit: s}\npose_capture:\n"
         "  position: {columns: [x, y, z], unit: m, frame: NED}\n"
         "  euler: {columns: [phi, theta, psi], unit: rad, world: NED, body: FRD}\n"
         "ahrs:\n  rates: {columns: [p, q, r], unit: rad/s, frame: FRD}\n"
         "dvl:\n  velocity: {columns: [u, v, w], unit: m/s, frame: FRD}\n"
         "thrusters:\n  inputs: {columns: [" +
         columns + "], units: [" + units + "]}\n" + (voltage ? "battery: {column: voltage, unit: V}\n" : "");
}

}  // namespace fathom::sealed

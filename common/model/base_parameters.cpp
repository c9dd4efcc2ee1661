#include "common/model/base_parameters.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/vehicle.hpp"

namespace fathom::model {
namespace {

constexpr double kGravity = 9.81;        // m/s^2
constexpr double kReferenceSpeed = 0.5;  // m/s and rad/s: where linear and quadratic drag are taken as equally large

// Quadratic drag of a plate of side L with drag coefficient 1: broadside, and turning about its middle line,
// 1/2 rho L 2 integral_0^{L/2} r^3 dr = 1/2 rho L^5 / 32.
double plate_drag(bool turning, double density, double length) {
  return 0.5 * density * (turning ? std::pow(length, 5.0) / 32.0 : length * length);
}

}  // namespace

const std::array<BaseParameter, 22>& base_parameters() {
  using enum ParameterKind;
  static constexpr std::array<BaseParameter, 22> kAll{{
      {"m_X", "kg", kInertia, 0},
      {"m_Y", "kg", kInertia, 1},
      {"m_Z", "kg", kInertia, 2},
      {"I_X", "kg m^2", kInertia, 3},
      {"I_Y", "kg m^2", kInertia, 4},
      {"I_Z", "kg m^2", kInertia, 5},
      {"X_u", "N/(m/s)", kLinearDrag, 0},
      {"Y_v", "N/(m/s)", kLinearDrag, 1},
      {"Z_w", "N/(m/s)", kLinearDrag, 2},
      {"K_p", "N m/(rad/s)", kLinearDrag, 3},
      {"M_q", "N m/(rad/s)", kLinearDrag, 4},
      {"N_r", "N m/(rad/s)", kLinearDrag, 5},
      {"X_u|u|", "N/(m/s)^2", kQuadraticDrag, 0},
      {"Y_v|v|", "N/(m/s)^2", kQuadraticDrag, 1},
      {"Z_w|w|", "N/(m/s)^2", kQuadraticDrag, 2},
      {"K_p|p|", "N m/(rad/s)^2", kQuadraticDrag, 3},
      {"M_q|q|", "N m/(rad/s)^2", kQuadraticDrag, 4},
      {"N_r|r|", "N m/(rad/s)^2", kQuadraticDrag, 5},
      {"W-B", "N", kWeight, 2},
      {"G_x", "N m", kMoment, 0},
      {"G_y", "N m", kMoment, 1},
      {"G_z", "N m", kMoment, 2},
  }};
  return kAll;
}

const BaseParameter* find_base_parameter(std::string_view name) {
  const auto& all = base_parameters();
  const auto found = std::find_if(all.begin(), all.end(), [&](const BaseParameter& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<std::string> default_parameters(const std::array<bool, 6>& dof) {
  const bool roll = dof[3];
  const bool pitch = dof[4];
  std::vector<std::string> names;
  for (const BaseParameter& one : base_parameters()) {
    // Moment G x R_WB^T e_z: roll feels G_y and G_z, pitch feels G_x and G_z.
    const bool wanted = one.kind == ParameterKind::kMoment
                            ? (one.axis == 0 && pitch) || (one.axis == 1 && roll) || (one.axis == 2 && (roll || pitch))
                            : dof[static_cast<std::size_t>(one.axis)];
    if (wanted) names.emplace_back(one.name);
  }
  return names;
}

Prior wide_prior(const BaseParameter& parameter, const Vehicle& vehicle) {
  const double mass = vehicle.mass;
  // An open frame is about twice as long as the cube of water that weighs as much.
  const double length = 2.0 * std::cbrt(mass / vehicle.water_density);
  const bool turning = parameter.axis >= 3;
  switch (parameter.kind) {
    case ParameterKind::kInertia: {
      const double stated = turning ? vehicle.inertia[parameter.axis - 3] : mass;
      const double rigid = stated > 0.0 ? stated : mass * length * length / 6.0;
      return {1.5 * rigid, 1.5 * rigid};  // added mass of half the body's, known to nobody
    }
    case ParameterKind::kLinearDrag: {
      const double drag = plate_drag(turning, vehicle.water_density, length) * kReferenceSpeed;
      return {-drag, 3.0 * drag};
    }
    case ParameterKind::kQuadraticDrag: {
      const double drag = plate_drag(turning, vehicle.water_density, length);
      return {-drag, 3.0 * drag};
    }
    case ParameterKind::kWeight:
      return {vehicle.buoyancy > 0.0 ? mass * kGravity - vehicle.buoyancy : 0.0, 0.1 * mass * kGravity};
    case ParameterKind::kMoment:
      return {0.0, 0.1 * mass * kGravity * length};
  }
  return {};
}

}  // namespace fathom::model

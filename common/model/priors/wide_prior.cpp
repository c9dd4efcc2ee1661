#include "common/model/priors/wide_prior.hpp"

#include <cmath>

#include "common/model/vehicle.hpp"

namespace fathom::model {
namespace {

constexpr double kNominalGravity = 9.81;  // m/s^2
constexpr double kReferenceSpeed = 0.5;   // m/s and rad/s: where linear and quadratic drag are taken as equally large

// Quadratic drag of a plate of side L with drag coefficient 1: broadside, and turning about its middle line,
// 1/2 rho L 2 integral_0^{L/2} r^3 dr = 1/2 rho L^5 / 32.
double plate_drag(bool turning, double density, double length) {
  return 0.5 * density * (turning ? std::pow(length, 5.0) / 32.0 : length * length);
}

}  // namespace

std::vector<std::string> default_parameters(const std::array<bool, 6>& dof) {
  const bool roll = dof[3];
  const bool pitch = dof[4];
  const bool yaw = dof[5];
  const bool tumbles = roll + pitch + yaw >= 2;
  std::vector<std::string> names;
  for (const BaseParameter one : base_parameters()) {
    bool wanted = dof[static_cast<std::size_t>(axis(one))];
    // (I_Y - I_X) p q and its like: two free rotations feel the third inertia, be it only passive.
    if (one == BaseParameter::I_X || one == BaseParameter::I_Y || one == BaseParameter::I_Z) wanted = wanted || tumbles;
    // m_Y r v, (m_Y - m_X) u v and their like: whoever moves ahead and turns feels how much water is moved by drifting
    // sideways, which a torpedo does though nothing drives it there.
    if (one == BaseParameter::m_X) wanted = wanted || (dof[1] && yaw) || (dof[2] && pitch);
    if (one == BaseParameter::m_Y) wanted = wanted || (dof[0] && yaw) || (dof[2] && roll);
    if (one == BaseParameter::m_Z) wanted = wanted || (dof[0] && pitch) || (dof[1] && roll);
    // A tilted vehicle's net weight pulls along it, too.
    if (one == BaseParameter::W_B) wanted = wanted || (dof[0] && pitch) || (dof[1] && roll);
    // Moment G x R_WB^T e_z: roll feels G_y and G_z, pitch feels G_x and G_z.
    if (one == BaseParameter::G_x) wanted = pitch;
    if (one == BaseParameter::G_y) wanted = roll;
    if (one == BaseParameter::G_z) wanted = roll || pitch;
    if (wanted) names.emplace_back(name(one));
  }
  return names;
}

Prior wide_prior(BaseParameter parameter, const Vehicle& vehicle) {
  const double mass = vehicle.mass;
  // An open frame is about twice as long as the cube of water that weighs as much.
  const double length = 2.0 * std::cbrt(mass / vehicle.water_density);
  if (parameter == BaseParameter::W_B) {
    return {vehicle.buoyancy > 0.0 ? mass * kNominalGravity - vehicle.buoyancy : 0.0, 0.1 * mass * kNominalGravity};
  }
  if (index(parameter) >= index(BaseParameter::G_x)) return {0.0, 0.1 * mass * kNominalGravity * length};
  const bool turning = axis(parameter) >= 3;
  if (sign_constraint(parameter) > 0) {
    const double stated = turning ? vehicle.inertia[axis(parameter) - 3] : mass;
    const double rigid = stated > 0.0 ? stated : mass * length * length / 6.0;
    return {1.5 * rigid, 1.5 * rigid};  // added mass of half the body's, known to nobody
  }
  const bool linear = index(parameter) < index(BaseParameter::X_uu);
  const double drag = plate_drag(turning, vehicle.water_density, length) * (linear ? kReferenceSpeed : 1.0);
  return {-drag, 3.0 * drag};
}

}  // namespace fathom::model

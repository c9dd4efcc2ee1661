// Equations of motion of the lumped Fossen model with effects: forward (acceleration) and inverse (required wrench).
//
//   (M + sum M_e) nu_dot + C_RB(nu) nu + C_A(nu_r) nu_r + D(nu_r) nu_r + g(R_WB) = tau(f) + sum w_e + M_A nu_c_dot
//
// M is diagonal and lumped (rigid plus added); the split into M_RB and M_A matters only when the water moves.
// docs/model.md numbers the terms. Not modelled here: off-diagonal inertia (effect cross_coupling), propeller torque.
#pragma once

#include <span>
#include <vector>

#include "common/model/effect.hpp"
#include "common/model/motion.hpp"
#include "common/model/parameters.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

using BaseTheta = Eigen::Matrix<double, kBaseParameterCount, 1>;

/// A vehicle with numbers: base parameters (SI, order of BaseParameter) and effects in the order in which they act.
struct Model {
  const Vehicle* vehicle{};
  Allocation allocation{};  ///< 6 x actuators; identity when the input is a wrench
  BaseTheta theta{BaseTheta::Zero()};
  std::vector<ActiveEffect> effects{};
  double input_hold{0.0};      ///< InputTiming::hold; from -1/2 to 1/2 it belongs to the recording, not to the vehicle
  bool motion_matters{false};  ///< wrenches of some actuators depend on flow or attitude (actuators.hpp)

  /// Puts an effect where the registry's order wants it.
  void add(ActiveEffect effect);
  /// Numbers of memory that the effects need together.
  [[nodiscard]] int memory_size() const;
};

/// Model of `vehicle` with no effects and theta at the priors' means; `input_is_wrench` chooses the identity
/// allocation.
[[nodiscard]] Model nominal_model(const Vehicle& vehicle, bool input_is_wrench);

/// All effects alter `motion` in turn. With `dt` > 0 their memory first advances by dt.
void feel(const Model& model, Motion& motion, std::span<double> memory, double dt);
/// Memory at rest in `motion`.
void settle(const Model& model, Motion motion, std::span<double> memory);

/// Drag of the hull at a velocity relative to the water, N and N m.
[[nodiscard]] Vector6d hull_drag(const Model& model, const Vector6d& nu_r);
/// Wrench of everything but inertia, applied thrust included: M nu_dot = generalised_force. Call after feel().
[[nodiscard]] Vector6d generalised_force(const Model& model, const Motion& motion, Load& load);
/// nu_dot [m/s^2, rad/s^2]; zero in degrees of freedom that the vehicle file leaves out, whose measured acceleration
/// (Motion::nu_dot_told) pushes the others where effects couple them. Call after feel().
[[nodiscard]] Vector6d acceleration(const Model& model, const Motion& motion);
/// Wrench that acts on the vehicle and that the model lacks: M nu_dot minus generalised force. The inverse of
/// acceleration(): residual_wrench(m, acceleration(m)) == 0 on the enabled degrees of freedom. Call after feel().
[[nodiscard]] Vector6d residual_wrench(const Model& model, const Motion& motion, const Vector6d& nu_dot);

}  // namespace fathom::model

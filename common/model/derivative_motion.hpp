// What acts on a vehicle of hydrodynamic derivatives: a rigid body with its added mass, the derivatives' products,
// umbilical and chain. Manoeuvres are flown by it, and the simulator moves by it who states derivatives as its truth.
#pragma once

#include "common/model/dynamics.hpp"

namespace fathom::model {

/// What pulls at the hull from outside.
struct Attached {
  Eigen::Vector3d F_umbilical_B{Eigen::Vector3d::Zero()};  ///< N at the attachment
  Eigen::Vector3d F_chain_B{Eigen::Vector3d::Zero()};
  Vector6d umbilical{Vector6d::Zero()}, chain{Vector6d::Zero()};  ///< N, N m at Bo, in B
};

/// Force of an umbilical of which `paid_out` [m] trail, at its attachment in B [N]: its drag.
[[nodiscard]] Eigen::Vector3d umbilical_drag(const Vehicle& vehicle, double paid_out, const Vector6d& nu,
                                             const Eigen::Vector3d& v_WF_B);
/// `pull_W` [N]: at the umbilical's attachment, besides its drag; `v_WF_B` [m/s]: the water's velocity.
[[nodiscard]] Attached attached(const Vehicle& vehicle, const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB,
                                const Vector6d& nu, const Eigen::Vector3d& pull_W,
                                const Eigen::Vector3d& v_WF_B = Eigen::Vector3d::Zero());
/// The rigid body's inertia about Bo [kg, kg m, kg m^2]: its mass stands at the centre of mass, about which the vehicle
/// file's inertia is.
[[nodiscard]] Matrix6d rigid_inertia(const Vehicle& vehicle);
/// The same and the added mass.
[[nodiscard]] Matrix6d total_inertia(const Vehicle& vehicle);
/// What the water's own motion does besides drag: the pressure that accelerates it acts on the hull, at the centre of
/// buoyancy, and added mass feels its acceleration as seen from a turning body. `a_WF_B` [m/s^2]: rate of v_WF in W,
/// along B.
[[nodiscard]] Vector6d water_wrench(const Vehicle& vehicle, const Eigen::Vector3d& w, const Eigen::Vector3d& v_WF_B,
                                    const Eigen::Vector3d& a_WF_B);
/// Weight, buoyancy and the rigid body's Coriolis forces [N, N m].
[[nodiscard]] Vector6d rigid_wrench(const Vehicle& vehicle, const Eigen::Vector3d& down_B, const Vector6d& nu);
/// InputError when the vehicle file lacks what such a motion needs.
void require_derivatives(const Vehicle& vehicle);

/// nu_dot of a model whose vehicle has derivatives: they stand in the place of the base parameters, effects act as on
/// any other. Call after feel().
[[nodiscard]] Vector6d derivative_acceleration(const Model& model, const Motion& motion, const Attached& attached);
/// nu_dot of this force [N, N m]: motions that the vehicle's set does not describe stay as they are.
[[nodiscard]] Vector6d accelerated(const Vehicle& vehicle, Matrix6d inertia, Vector6d force);
/// The base parameters nearest to the derivatives: inertia, weight and restoring moments are the same, drag along each
/// axis is that of its own square.
[[nodiscard]] BaseTheta nearest_base(const Vehicle& vehicle);

}  // namespace fathom::model

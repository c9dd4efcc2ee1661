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

/// `pull_W` [N]: at the umbilical's attachment, besides its drag; `v_WF_B` [m/s]: the water's velocity.
[[nodiscard]] Attached attached(const Vehicle& vehicle, const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB,
                                const Vector6d& nu, const Eigen::Vector3d& pull_W,
                                const Eigen::Vector3d& v_WF_B = Eigen::Vector3d::Zero());
/// Diagonal of rigid body and added mass [kg, kg m^2].
[[nodiscard]] Vector6d total_inertia(const Vehicle& vehicle);
/// Weight, buoyancy and the rigid body's Coriolis forces [N, N m].
[[nodiscard]] Vector6d rigid_wrench(const Vehicle& vehicle, const Eigen::Vector3d& down_B, const Vector6d& nu);
/// InputError when the vehicle file lacks what such a motion needs.
void require_derivatives(const Vehicle& vehicle);

/// nu_dot of a model whose vehicle has derivatives: they stand in the place of the base parameters, effects act as on
/// any other. Call after feel().
[[nodiscard]] Vector6d derivative_acceleration(const Model& model, const Motion& motion, const Attached& attached);
/// The base parameters nearest to the derivatives: inertia, weight and restoring moments are the same, drag along each
/// axis is that of its own square.
[[nodiscard]] BaseTheta nearest_base(const Vehicle& vehicle);

}  // namespace fathom::model

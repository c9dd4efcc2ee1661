// What water does to a craft that lives by its flow along it, beyond Fossen's diagonal drag: propellers that advance,
// fins and hulls that lift and stall, cross-flow drag by strips. Of an ROV nothing of it.
#pragma once

#include "test/sealed/craft/craft.hpp"

namespace fathom::sealed {

/// The told forces as they act in this motion [N; N m of a moved weight]: propellers and fins by their laws.
[[nodiscard]] Eigen::VectorXd acting_forces(const Craft& craft, const Eigen::VectorXd& told, const Vector6& nu_r);

/// Wrench of the acting forces; weights pull along `down`, the world's down in the body.
[[nodiscard]] Vector6 push_of(const Craft& craft, const Eigen::VectorXd& acting, const Eigen::Vector3d& down);

/// Wrench of everything else that the flow does: lift and induced drag of foils and hull, what a fin does beside the
/// force that its deflection alone gives, cross-flow drag beyond that of pure motions, the propellers' torque.
[[nodiscard]] Vector6 flow_wrench(const Craft& craft, const Eigen::VectorXd& told, const Vector6& nu_r);

/// Cross-flow drag of pure sway, heave, pitch and yaw: the hull's diagonal quadratic numbers (positive).
[[nodiscard]] Vector6 pure_cross_drag(const Craft& craft);

}  // namespace fathom::sealed

// Rotations and cross products in Fossen's conventions: W = NED world, B = forward-right-down body.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fathom {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// skew(a) * b == a x b.
[[nodiscard]] inline Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d s;
  s << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return s;
}

/// R_WB from roll, pitch, yaw [rad], ZYX order (Fossen 2011, eq. 2.18).
[[nodiscard]] Eigen::Matrix3d rotation_from_euler(const Eigen::Vector3d& euler);

/// Roll, pitch, yaw [rad] of R_WB; pitch in [-pi/2, pi/2].
[[nodiscard]] Eigen::Vector3d euler_from_rotation(const Eigen::Matrix3d& R_WB);

/// Rotation by the vector `phi` [rad] (exponential map), exact for small angles too.
[[nodiscard]] Eigen::Quaterniond quaternion_from_rotation_vector(const Eigen::Vector3d& phi);

/// Rotation vector [rad] of q, the shortest way round: the inverse of the above.
[[nodiscard]] Eigen::Vector3d rotation_vector_from_quaternion(const Eigen::Quaterniond& q);

/// Turn in B [rad] that a small change of a rotation vector makes: exp(phi + d) = exp(phi) exp(J d) (Sola et al. 2018,
/// eq. 143).
[[nodiscard]] Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& phi);

/// Angle folded into (-pi, pi].
[[nodiscard]] double wrap_angle(double angle);

}  // namespace fathom

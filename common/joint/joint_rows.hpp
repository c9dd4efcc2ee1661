// What each instrument tells the joint filter: innovations at a state, with their derivatives by it. Geometry as in the
// estimator's complementary filter (common/estimation/online/camera_geometry.hpp). Variances are the caller's.
#pragma once

#include "common/estimation/online/camera_geometry.hpp"
#include "common/joint/joint_filter.hpp"

namespace fathom::joint {

/// The attitude that the state makes of the told one.
[[nodiscard]] Eigen::Matrix3d true_attitude(const JointVector& x, const Eigen::Matrix3d& told);

/// A point known in the world, p_WT [m], seen at `arm` [m] from the body: p_WT - R arm - p. Three rows.
void see_point(const JointVector& x, const Eigen::Matrix3d& told, const Eigen::Vector3d& p_WT,
               const Eigen::Vector3d& arm, std::span<JointRow, 3> rows);
/// The floor, at depth `floor` [m], seen at `arm` by the laser.
void see_floor(const JointVector& x, const Eigen::Matrix3d& told, double floor, const Eigen::Vector3d& arm,
               JointRow& row);
/// Distance of a camera to the floor along its axis [m]; not positive when it looks away.
[[nodiscard]] double distance(const JointVector& x, const Eigen::Matrix3d& told, double floor,
                              const estimation::CameraMount& camera);
/// Flow of the floor [1/s], as a velocity [m/s] along the camera's axes; distance() must be positive. Its rotation was
/// taken out with the gyros, whose turned axes therefore show in it.
void see_flow(const JointVector& x, const Eigen::Matrix3d& told, double floor, const estimation::CameraMount& camera,
              const Eigen::Vector3d& flow, std::span<JointRow, 3> rows);
/// A velocity log's velocity of the body [m/s].
void see_velocity(const JointVector& x, const Eigen::Vector3d& v_B, std::span<JointRow, 3> rows);
/// Rates as gyros tell them [rad/s], about axes that are turned a little.
void see_rates(const JointVector& x, const Eigen::Vector3d& w, std::span<JointRow, 3> rows);
/// One number of the state itself.
void see_state(const JointVector& x, int which, double value, JointRow& row);

/// What the accelerometer feels beside the state.
struct Felt {
  const Eigen::Matrix3d& told;
  /// R_WB from the sample before, turned on by the gyro. The model takes its tilt from it: a column of W-B, G_x, G_y
  /// that had the noise of the gravity it is compared with would be learnt from that noise (errors in variables).
  const Eigen::Matrix3d& carried;
  const Vector6d& tau;           ///< N, N m
  const Eigen::Vector3d& w_dot;  ///< rad/s^2, of the axes that no model moves
  const Eigen::Vector3d& p_BI;   ///< m, where it sits
  double gravity;                ///< m/s^2
};
/// Specific force f [m/s^2] at the instrument, which the model foretells:
///   v_dot + w x v + w_dot x r + w x (w x r) - g down, turned like the gyros, + bias
/// One row for each axis of X Y Z that the model moves; how many.
std::size_t feel_force(const Normalised& model, const JointVector& x, const Felt& felt, const Eigen::Vector3d& f,
                       std::span<JointRow, 3> rows);

}  // namespace fathom::joint

// What a camera that looks at the floor says about the vehicle: the measurement equations of Karras et al. (1.24-1.28)
// in their corrected form, both ways. Attitude comes from the attitude sensor.
#pragma once

#include <Eigen/Core>

namespace fathom::estimation {

/// Where a camera sits: Co in the body, and the camera's axes (x right, y down, z out) in the body's.
struct CameraMount {
  Eigen::Vector3d p_BC{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d R_BC{Eigen::Matrix3d::Identity()};
};

/// (1.24), (1.28): p_WB = p_WT - R_WB (p_BC + R_BC p_CT).
[[nodiscard]] Eigen::Vector3d position_from_tag(const Eigen::Vector3d& p_WT, const Eigen::Vector3d& p_CT,
                                                const CameraMount& mount, const Eigen::Matrix3d& R_WB);
/// (1.26): distance along the optical axis to a level floor at depth `floor` [m]; not positive when it looks away.
[[nodiscard]] double distance_to_floor(double floor, const Eigen::Vector3d& p_WB, const CameraMount& mount,
                                       const Eigen::Matrix3d& R_WB);
/// (1.28): z of the body from a point on the floor seen at p_CL.
[[nodiscard]] double depth_from_floor_point(double floor, const Eigen::Vector3d& p_CL, const CameraMount& mount,
                                            const Eigen::Matrix3d& R_WB);
/// (1.25) solved: velocity of Co in C, from the scene's motion `flow` [1/s], rotation removed already, at `distance`
/// [m]. The scene moves opposite to the camera.
[[nodiscard]] Eigen::Vector3d velocity_from_flow(const Eigen::Vector3d& flow, double distance);
/// v_B + w x p_BC, in C.
[[nodiscard]] Eigen::Vector3d velocity_of_camera(const Eigen::Vector3d& v_B, const Eigen::Vector3d& w_B,
                                                 const CameraMount& mount);

}  // namespace fathom::estimation

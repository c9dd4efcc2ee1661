#include "common/estimation/online/camera_geometry.hpp"

#include <Eigen/Geometry>

namespace fathom::estimation {

Eigen::Vector3d position_from_tag(const Eigen::Vector3d& p_WT, const Eigen::Vector3d& p_CT, const CameraMount& mount,
                                  const Eigen::Matrix3d& R_WB) {
  return p_WT - R_WB * (mount.p_BC + mount.R_BC * p_CT);
}

double distance_to_floor(double floor, const Eigen::Vector3d& p_WB, const CameraMount& mount,
                         const Eigen::Matrix3d& R_WB) {
  const Eigen::RowVector3d down_B = R_WB.row(2);
  const double height = floor - p_WB.z() - down_B.dot(mount.p_BC);
  return height / down_B.dot(mount.R_BC.col(2));
}

double depth_from_floor_point(double floor, const Eigen::Vector3d& p_CL, const CameraMount& mount,
                              const Eigen::Matrix3d& R_WB) {
  return floor - R_WB.row(2).dot(mount.p_BC + mount.R_BC * p_CL);
}

Eigen::Vector3d velocity_from_flow(const Eigen::Vector3d& flow, double distance) { return -distance * flow; }

Eigen::Vector3d velocity_of_camera(const Eigen::Vector3d& v_B, const Eigen::Vector3d& w_B, const CameraMount& mount) {
  return mount.R_BC.transpose() * (v_B + w_B.cross(mount.p_BC));
}

}  // namespace fathom::estimation

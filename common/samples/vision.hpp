// Pictures and what vision makes of them. Frame C of a camera: x right, y down, z out.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace fathom {

/// One compressed picture.
struct Camera {
  Utime utime{};                   ///< middle of the exposure
  std::string camera;              ///< name in the vehicle file
  int width{};                     ///< px
  int height{};                    ///< px
  std::vector<std::uint8_t> jpeg;  ///< JPEG file
};

/// Pose of one fiducial tag as a camera saw it.
struct TagPose {
  Utime utime{};
  std::string camera;                                       ///< name in the vehicle file
  int tag{};                                                ///< number of the tag, its frame T
  Eigen::Vector3d p_CT{Eigen::Vector3d::Zero()};            ///< m
  Eigen::Quaterniond q_CT{Eigen::Quaterniond::Identity()};  ///< unit
  double reprojection_error{};                              ///< px, root mean square over the corners
};

/// Mean motion of the scene between two pictures, the camera's rotation removed.
struct OpticalFlow {
  Utime utime{};       ///< middle between the two pictures
  std::string camera;  ///< name in the vehicle file
  double interval{};   ///< s between the two pictures
  /// 1/s: minus the camera's velocity in C over its distance to the scene along z. Along x and y it is the scene's
  /// angular motion, along z minus the rate at which its picture grows.
  Eigen::Vector3d flow_C{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d covariance{Eigen::Vector3d{0.0, 0.0, -1.0}.asDiagonal()};  ///< 1/s^2
  int n_tracks{};                                                            ///< features that agreed

  /// False where only the motion across the optical axis was measured.
  [[nodiscard]] bool tells_approach() const { return covariance(2, 2) >= 0.0; }
  /// rad/s, standard deviation of either component across.
  [[nodiscard]] double sigma_across() const { return std::sqrt(0.5 * (covariance(0, 0) + covariance(1, 1))); }
  /// Both components across with that standard deviation, and nothing along the axis.
  [[nodiscard]] static Eigen::Matrix3d only_across(double sigma) {
    return Eigen::Vector3d{sigma * sigma, sigma * sigma, -1.0}.asDiagonal();
  }
};

/// Distance from the picture of a laser dot L.
struct LaserRange {
  Utime utime{};
  std::string camera;                             ///< name in the vehicle file
  Eigen::Vector3d p_CL{Eigen::Vector3d::Zero()};  ///< m
  double sigma_range{};                           ///< m along the line of sight
};

}  // namespace fathom

// Pictures and what vision makes of them. Frame C of a camera: x right, y down, z out.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
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
  Utime utime{};                                    ///< middle between the two pictures
  std::string camera;                               ///< name in the vehicle file
  double interval{};                                ///< s between the two pictures
  Eigen::Vector2d flow_C{Eigen::Vector2d::Zero()};  ///< rad/s along x and y of C
  double sigma{};                                   ///< rad/s, of each component
  int n_tracks{};                                   ///< features that agreed
};

/// Distance from the picture of a laser dot L.
struct LaserRange {
  Utime utime{};
  std::string camera;                             ///< name in the vehicle file
  Eigen::Vector3d p_CL{Eigen::Vector3d::Zero()};  ///< m
  double sigma_range{};                           ///< m along the line of sight
};

}  // namespace fathom

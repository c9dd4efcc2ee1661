// A camera at an instant: its pose and what its picture holds.
#pragma once

#include "common/simulation/sensor.hpp"

namespace fathom::simulation {

struct CameraView {
  const model::CameraMount& camera;
  Eigen::Vector3d p_WC;
  Eigen::Matrix3d R_WC;

  CameraView(const model::CameraMount& mount, const Moment& moment)
      : camera{mount}, p_WC{moment.p_WB + moment.R_WB * mount.mount.p_BS}, R_WC{moment.R_WB * mount.mount.R_BS} {}

  [[nodiscard]] Eigen::Vector3d in_camera(const Eigen::Vector3d& p_W) const { return R_WC.transpose() * (p_W - p_WC); }

  /// True when the point, given in C, is in front of the lens and inside the picture.
  [[nodiscard]] bool sees(const Eigen::Vector3d& p_C) const {
    if (p_C.z() <= 0.0) return false;
    const double x = camera.focal * p_C.x() / p_C.z(), y = camera.focal * p_C.y() / p_C.z();
    return std::abs(x) <= 0.5 * camera.width && std::abs(y) <= 0.5 * camera.height;
  }
};

}  // namespace fathom::simulation

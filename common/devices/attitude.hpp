// Attitude samples from what instruments call roll, pitch and heading, and their mounting.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <numbers>

#include "common/base/spatial.hpp"
#include "common/samples/sensors.hpp"

namespace fathom::devices {

inline constexpr double kRadians = std::numbers::pi / 180.0;

/// Roll, pitch, heading [rad] of an instrument with axes forward, right, down, to the body's attitude.
[[nodiscard]] inline Eigen::Quaterniond body_attitude(const Eigen::Vector3d& euler, const Eigen::Matrix3d& R_BS) {
  return Eigen::Quaterniond{rotation_from_euler(euler) * R_BS.transpose()}.normalized();
}

/// Turns an instrument's rates and specific force into the body's axes.
inline void mount(Ahrs& sample, const Eigen::Matrix3d& R_BS) {
  sample.w_WB_B = R_BS * sample.w_WB_B;
  sample.f_B = R_BS * sample.f_B;
}

}  // namespace fathom::devices

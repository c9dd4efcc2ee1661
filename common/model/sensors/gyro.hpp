// One rate gyro in any direction, with a bias (Pereira and Duncan, eq. 14): z = d . w + bias.
#pragma once

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

struct Gyro {
  Eigen::Vector3d direction_B{Eigen::Vector3d::UnitX()};  ///< unit: its direction cosines
  int bias{-1};                                           ///< the bias state that it adds, from at::kBias; -1: none
};

/// `measured` and the root of `variance` in rad/s.
[[nodiscard]] Observation observe(const KinematicPoint& point, const Gyro& sensor, double measured, double variance);

}  // namespace fathom::model

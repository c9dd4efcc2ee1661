// One accelerometer anywhere in the hull, in any direction, with a bias (Pereira and Duncan, eqs. 12, 13):
//   z = d . (a_O + w x (w x r) + w_dot x r - R_WB^T g) + bias
// a_O is the inertial acceleration of the body's origin, not the derivative of (u v w).
#pragma once

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

struct Accelerometer {
  Eigen::Vector3d p_BI{Eigen::Vector3d::Zero()};          ///< m
  Eigen::Vector3d direction_B{Eigen::Vector3d::UnitX()};  ///< unit: its direction cosines
  int bias{-1};                                           ///< the bias state that it adds, from at::kBias; -1: none
  double gravity{kGravity};                               ///< m/s^2, where it is
};

/// `measured` and the root of `variance` in m/s^2; at rest and level an accelerometer along z says -g.
[[nodiscard]] Observation observe(const KinematicPoint& point, const Accelerometer& sensor, double measured,
                                  double variance);

}  // namespace fathom::model

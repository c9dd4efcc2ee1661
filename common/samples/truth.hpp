// What the simulator knows, for plots and tests alone; no mind hears it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/base/spatial.hpp"
#include "common/base/time.hpp"

namespace fathom {

struct Truth {
  Utime utime{};
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};            ///< m, NED
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};  ///< unit
  Vector6d nu{Vector6d::Zero()};                            ///< m/s, rad/s: u v w p q r
  Vector6d nu_dot{Vector6d::Zero()};                        ///< m/s^2, rad/s^2
  Eigen::Vector3d v_WF{Eigen::Vector3d::Zero()};            ///< m/s, velocity of the water, NED
  Vector6d tau_felt{Vector6d::Zero()};                      ///< N, N m: the thrusters' wrench as felt, body axes
};

}  // namespace fathom

// A fix of three coordinates: USBL, motion capture, or what a seen tag says.
#pragma once

#include <array>

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

/// Position [m] in W of the point p_BP of the hull.
[[nodiscard]] std::array<Observation, 3> observe_position(const KinematicPoint& point, const Eigen::Vector3d& p_BP,
                                                          const Eigen::Vector3d& measured,
                                                          const Eigen::Vector3d& variance);

}  // namespace fathom::model

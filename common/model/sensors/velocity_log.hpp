// A Doppler log: velocity of the point p_BD of the hull over ground, in B: z = R_WB^T v + w x p_BD.
#pragma once

#include <array>

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

/// m/s along B's axes.
[[nodiscard]] std::array<Observation, 3> observe_velocity(const KinematicPoint& point, const Eigen::Vector3d& p_BD,
                                                          const Eigen::Vector3d& measured, double variance);

}  // namespace fathom::model

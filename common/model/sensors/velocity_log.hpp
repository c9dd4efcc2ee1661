// A Doppler log: velocity of the point p_BD of the hull over ground, in B: z = R_WB^T v + w x p_BD, and a bias of the log
// where the state has one.
#pragma once

#include <array>

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

/// m/s along B's axes; `biased`: the state's bias of the log is in what is measured.
[[nodiscard]] std::array<Observation, 3> observe_velocity(const KinematicPoint& point, const Eigen::Vector3d& p_BD,
                                                          const Eigen::Vector3d& measured, double variance,
                                                          bool biased = false);

}  // namespace fathom::model

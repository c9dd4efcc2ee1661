// A measured attitude: motion capture, an AHRS, or a seen tag. The innovation is the rotation vector from the estimate
// to the measurement, in B.
#pragma once

#include <array>

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

/// Rotation in B [rad], the same variance about every axis.
[[nodiscard]] std::array<Observation, 3> observe_attitude(const KinematicPoint& point,
                                                          const Eigen::Quaterniond& measured, double variance);

/// Rotation in W [rad], the innovation likewise, with `variance` about north, east and down: the heading has an
/// instrument of its own.
[[nodiscard]] std::array<Observation, 3> observe_attitude(const KinematicPoint& point,
                                                          const Eigen::Quaterniond& measured,
                                                          const Eigen::Vector3d& variance);

}  // namespace fathom::model

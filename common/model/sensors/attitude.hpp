// A measured attitude: motion capture, an AHRS, or a seen tag. The innovation is the rotation vector from the estimate
// to the measurement, in B.
#pragma once

#include <array>

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

/// Rotation in B [rad], the same variance about every axis.
[[nodiscard]] std::array<Observation, 3> observe_attitude(const KinematicPoint& point,
                                                          const Eigen::Quaterniond& measured, double variance);

}  // namespace fathom::model

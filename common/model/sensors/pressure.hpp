// A pressure port: the depth of its place on the hull.
#pragma once

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

/// Depth z [m] of a port at p_BP: z = p_WB.z + (R_WB p_BP).z. Tilt plays a part only through the lever arm.
[[nodiscard]] Observation observe_depth(const KinematicPoint& point, const Eigen::Vector3d& p_BP, double measured,
                                        double variance);

}  // namespace fathom::model

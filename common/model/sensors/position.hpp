// Sensors of position: a pressure port (depth), acoustic ranges to transponders, and fixes of three coordinates.
#pragma once

#include <array>

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

/// Depth z [m] of a port at p_BP: z = p_WB.z + (R_WB p_BP).z. Tilt plays a part only through the lever arm.
[[nodiscard]] Observation observe_depth(const KinematicPoint& point, const Eigen::Vector3d& p_BP, double measured,
                                        double variance);

/// Range [m] from a transducer at p_BP to a transponder at p_WT (Pereira and Duncan, eq. 15, with lever arm). Within
/// a millimetre of the transponder there is no direction: the row is zero.
[[nodiscard]] Observation observe_range(const KinematicPoint& point, const Eigen::Vector3d& p_BP,
                                        const Eigen::Vector3d& p_WT, double measured, double variance);

/// Position [m] in W of the point p_BP of the hull: USBL, motion capture, or what a seen tag says.
[[nodiscard]] std::array<Observation, 3> observe_position(const KinematicPoint& point, const Eigen::Vector3d& p_BP,
                                                          const Eigen::Vector3d& measured,
                                                          const Eigen::Vector3d& variance);

}  // namespace fathom::model

// An acoustic range from a transducer on the hull to a transponder at a known place.
#pragma once

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

/// Range [m] from a transducer at p_BP to a transponder at p_WT (Pereira and Duncan, eq. 15, with lever arm). Within
/// a millimetre of the transponder there is no direction: the row is zero.
[[nodiscard]] Observation observe_range(const KinematicPoint& point, const Eigen::Vector3d& p_BP,
                                        const Eigen::Vector3d& p_WT, double measured, double variance);

}  // namespace fathom::model

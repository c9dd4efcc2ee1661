// A flux-gate compass: z = yaw - declination. Declination is how far magnetic north lies east of true north.
// Not modelled: the vehicle's own iron (deviation), the tilt error of a compass that is not gimballed.
#pragma once

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

/// All in rad; the innovation is folded into (-pi, pi].
[[nodiscard]] Observation observe_heading(const KinematicPoint& point, double declination, double measured,
                                          double variance);

}  // namespace fathom::model

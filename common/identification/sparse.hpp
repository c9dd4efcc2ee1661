// A trial at a lower rate: local means on a coarser grid. A vehicle's motion has nothing to say above a few hertz, and
// searching costs in proportion to the samples.
#pragma once

#include "common/samples/trial.hpp"

namespace fathom::identification {

/// `trial` with a step of at least `dt` [s]; unchanged when its own is more than half of that. Means are centred on the
/// kept samples, so nothing is delayed; velocities and inputs are averaged, poses and voltages are picked.
[[nodiscard]] Trial sparse(const Trial& trial, double dt);

}  // namespace fathom::identification

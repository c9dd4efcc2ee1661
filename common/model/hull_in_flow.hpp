// Which craft live by the flow along their hull, and which of them run along the surface.
#pragma once

#include "common/model/vehicle.hpp"

namespace fathom::model {

/// Whether its file says that the water's flow along it steers or carries the craft, or that it stands above the water:
/// rudders, fins, propellers by shaft speed, weights that drive a glider, windage, or, of a boat, that nothing pushes
/// it sideways. An open frame has no hull that lifts, and each further question about it would only make the answers to
/// the others less sure.
[[nodiscard]] bool lives_by_flow(const Vehicle& vehicle);

/// m^2, side view of what stands above the water where the file does not state it: half of the hull's side, of a craft
/// that lives by flow and is moved in the horizontal plane alone; else 0. The square of the wind that is found takes up
/// what it is wrong by.
[[nodiscard]] double assumed_windage(const Vehicle& vehicle);

}  // namespace fathom::model

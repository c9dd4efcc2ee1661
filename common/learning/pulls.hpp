// Lines that end at a point of the world: what they pull, slack up to a length, and what goes with how much of them is
// out. Where the search of points and lengths begins.
#pragma once

#include <vector>

#include "common/learning/room.hpp"
#include "common/model/learned/features.hpp"

namespace fathom::learning {

/// How far a point is, which is sought too: coarser than those below.
[[nodiscard]] std::vector<model::Factor> distances_of(const Room& room);
/// The same in the plan alone.
[[nodiscard]] std::vector<model::Factor> plan_distances_of(const Room& room);
/// Middle, and all around within and beyond where it was; slack nowhere, in a part of it, or nearly everywhere.
[[nodiscard]] std::vector<model::Factor> stretches_of(const Room& room);

}  // namespace fathom::learning

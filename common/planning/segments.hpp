// Segments that a plan chooses from: each moves one axis, or few, in a way that can be said in a few words.
#pragma once

#include <vector>

#include "common/excitation/design.hpp"

namespace fathom::planning {

/// Of the axes that move and may be pushed (`largest` > 0).
[[nodiscard]] std::vector<excitation::Segment> segments(const model::Vehicle& vehicle, const Vector6d& largest);

}  // namespace fathom::planning

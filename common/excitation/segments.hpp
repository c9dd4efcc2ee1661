// Segments that have a name: each moves one axis, or few, in a way that can be said in a few words. A plan chooses from
// them, an operator orders one, the supervisor flies it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/excitation/design.hpp"
#include "common/model/manoeuvres.hpp"

namespace fathom::excitation {

/// Of the axes that move and may be pushed (`largest` > 0).
[[nodiscard]] std::vector<Segment> segments(const model::Vehicle& vehicle, const Vector6d& largest);
/// The one of that name; nothing when there is none.
[[nodiscard]] std::optional<Segment> segment_named(const std::string& name, const model::Vehicle& vehicle,
                                                   const Vector6d& largest);

/// line, zigzag and circle as a vehicle of any thrusters flies them: thrust and difference are shares of the largest
/// force ahead and of the largest moment in yaw. Nothing for another name.
[[nodiscard]] std::optional<model::Manoeuvre> preset_named(const std::string& name);
/// What it moves and how long; nothing for a vehicle that cannot be pushed ahead, or turned where it must.
[[nodiscard]] std::optional<Segment> segment_of(const model::Manoeuvre& preset, const std::string& name,
                                                const model::Vehicle& vehicle, const Vector6d& largest);

}  // namespace fathom::excitation

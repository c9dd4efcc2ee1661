// Components that a table lacks, one of three velocities, say: zero where the vehicle does not move along them.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "common/tables/column_map.hpp"

namespace fathom::tables {

/// Which of surge, sway, heave, roll, pitch, yaw a vehicle file simulates.
using SimulatedAxes = std::array<bool, 6>;

/// Brings every group of the map to its full width: columns of a shorter list go to the components that simulated axes
/// need, in order, the others are marked absent. Returns the note about what is taken as zero, empty when nothing is.
/// InputError, with the axis and the remedy, when an absent component belongs to a simulated axis, or when the axes are
/// not known. `path` is the table's.
[[nodiscard]] std::string complete_groups(ColumnMap& map, const std::string& path,
                                          const std::optional<SimulatedAxes>& simulated);

}  // namespace fathom::tables

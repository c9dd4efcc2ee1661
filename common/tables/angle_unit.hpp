// Angles in degrees where radians are meant, or the reverse: nothing in the numbers themselves says so, but headings
// must carry velocities along the track.
#pragma once

#include "common/tables/readers.hpp"

namespace fathom::tables {

/// InputError, with the remedy, when the measured velocities follow the measured track with the headings read in the
/// other unit, and do not as they are. Says nothing without positions, velocities and Euler angles in one table, or
/// where the map turns their frames.
void check_angle_unit(Resolver& resolve, const ColumnMap& map, const Rows& rows, const CsvTable& table);

}  // namespace fathom::tables

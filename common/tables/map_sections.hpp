// Sections of a map that have a source of their own. Within the room alone.
#pragma once

#include "common/base/config.hpp"
#include "common/tables/column_map.hpp"

namespace fathom::tables::map_sections {

[[nodiscard]] ThrusterColumns thrusters_of(const Config& section);
[[nodiscard]] UsblColumns usbl_of(const Config& section);
[[nodiscard]] TagColumns tags_of(const Config& section);
[[nodiscard]] FlowColumns flow_of(const Config& section);
[[nodiscard]] LaserColumns laser_of(const Config& section);
/// `speed`, `from` and whether they are of the true or the apparent wind.
[[nodiscard]] SignalColumns wind_of(const Config& section);
/// `columns` and a unit for each, whatever they measure.
[[nodiscard]] SignalColumns signals_of(const Config& section);

}  // namespace fathom::tables::map_sections

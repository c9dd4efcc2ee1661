// Tethers, walls, depth, and what the vehicle carries.
#pragma once

#include "test/sealed/mechanisms/mechanism.hpp"

namespace fathom::sealed {
[[nodiscard]] std::vector<Entry> site_mechanisms();
/// The water's surface: drawn by name alone.
[[nodiscard]] std::vector<Entry> surface_mechanisms();
}  // namespace fathom::sealed

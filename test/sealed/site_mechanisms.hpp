// Tethers, walls, depth, and what the vehicle carries.
#pragma once

#include "test/sealed/mechanism.hpp"

namespace fathom::sealed {
[[nodiscard]] std::vector<Entry> site_mechanisms();
}

// What the water does to the hull beyond diagonal added mass and drag.
#pragma once

#include "test/sealed/mechanisms/mechanism.hpp"

namespace fathom::sealed {
[[nodiscard]] std::vector<Entry> water_mechanisms();
}

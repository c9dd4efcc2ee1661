// What thrusters do to the hull, and the surface to them.
#pragma once

#include "test/sealed/mechanisms/mechanism.hpp"

namespace fathom::sealed {
[[nodiscard]] std::vector<Entry> interaction_mechanisms();
}

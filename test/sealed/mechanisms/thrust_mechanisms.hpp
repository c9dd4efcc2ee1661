// Between the thrust that was asked for and the thrust that the water feels.
#pragma once

#include "test/sealed/mechanisms/mechanism.hpp"

namespace fathom::sealed {
[[nodiscard]] std::vector<Entry> thrust_mechanisms();
}

// Instruments that are late, out of scale or mounted elsewhere; and noise that is not white.
#pragma once

#include "test/sealed/mechanisms/mechanism.hpp"

namespace fathom::sealed {
[[nodiscard]] std::vector<Entry> sensor_mechanisms();
}

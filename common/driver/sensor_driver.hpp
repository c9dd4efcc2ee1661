// What every sensor driver does: a line, a parser, time, health, and messages. A driver's main() is one call.
#pragma once

#include "common/devices/protocols.hpp"

namespace fathom::driver {

/// The main() of a sensor driver: "ahrs_driver" and so on, with the protocols of its kind.
int sensor_main(const char* name, devices::Kind kind, int argc, const char* const* argv);

}  // namespace fathom::driver

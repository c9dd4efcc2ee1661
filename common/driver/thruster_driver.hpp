// The thrusters' driver: WRENCH_COMMAND and OPERATOR in, pulse widths out, THRUSTERS and BATTERY told.
#pragma once

namespace fathom::driver {

/// The main() of thruster_driver.
int thruster_main(int argc, const char* const* argv);

}  // namespace fathom::driver

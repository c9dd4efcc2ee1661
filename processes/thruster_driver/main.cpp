// thruster_driver: WRENCH_COMMAND in, pulse widths to the thrusters, THRUSTERS and BATTERY out.
#include "common/driver/thruster_driver.hpp"

int main(int argc, char** argv) { return fathom::driver::thruster_main(argc, argv); }

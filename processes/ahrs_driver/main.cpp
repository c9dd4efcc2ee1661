// ahrs_driver: the bytes of an attitude sensor in, AHRS out.
#include "common/driver/sensor_driver.hpp"

int main(int argc, char** argv) {
  return fathom::driver::sensor_main("ahrs_driver", fathom::devices::Kind::kAhrs, argc, argv);
}

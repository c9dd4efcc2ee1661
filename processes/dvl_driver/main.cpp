// dvl_driver: the bytes of a velocity log in, DVL out.
#include "common/driver/sensor_driver.hpp"

int main(int argc, char** argv) {
  return fathom::driver::sensor_main("dvl_driver", fathom::devices::Kind::kDvl, argc, argv);
}

// load_driver: the bytes of load cells in, LOADS out.
#include "common/driver/sensor_driver.hpp"

int main(int argc, char** argv) {
  return fathom::driver::sensor_main("load_driver", fathom::devices::Kind::kLoads, argc, argv);
}

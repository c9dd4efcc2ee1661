// range_driver: the bytes of acoustic ranges in, RANGES out.
#include "common/driver/sensor_driver.hpp"

int main(int argc, char** argv) {
  return fathom::driver::sensor_main("range_driver", fathom::devices::Kind::kRanges, argc, argv);
}

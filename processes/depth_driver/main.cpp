// depth_driver: the bytes of a depth sensor in, DEPTH out.
#include "common/driver/sensor_driver.hpp"

int main(int argc, char** argv) {
  return fathom::driver::sensor_main("depth_driver", fathom::devices::Kind::kDepth, argc, argv);
}

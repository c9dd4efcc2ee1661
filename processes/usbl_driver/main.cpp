// usbl_driver: the bytes of an acoustic positioning system in, USBL out.
#include "common/driver/sensor_driver.hpp"

int main(int argc, char** argv) {
  return fathom::driver::sensor_main("usbl_driver", fathom::devices::Kind::kUsbl, argc, argv);
}

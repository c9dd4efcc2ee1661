#include "common/link/i2c.hpp"

#include <fcntl.h>
#include <linux/i2c-dev.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "common/base/error.hpp"

namespace fathom::link {

LinuxI2c::LinuxI2c(std::string path) : path_{std::move(path)}, descriptor_{open(path_.c_str(), O_RDWR | O_CLOEXEC)} {
  if (descriptor_ >= 0) return;
  if (errno == EACCES)
    throw InputError(path_ + ": no permission; add the user to the group i2c (usermod -aG i2c NAME)");
  throw InputError(path_ + ": no such I2C bus; is it switched on? (ls /dev/i2c-*)");
}

LinuxI2c::~LinuxI2c() { close(descriptor_); }

void LinuxI2c::choose(std::uint8_t address) {
  if (ioctl(descriptor_, I2C_SLAVE, static_cast<unsigned long>(address)) < 0) {
    throw InputError(path_ + ": is no I2C bus, or a kernel driver holds the address; check the configuration");
  }
}

void LinuxI2c::write(std::uint8_t address, std::uint8_t command) {
  choose(address);
  if (::write(descriptor_, &command, 1) != 1) {
    throw InputError(path_ + ": nothing answers at address " + std::to_string(int{address}) +
                     "; check wiring and power");
  }
}

void LinuxI2c::read(std::uint8_t address, std::span<std::uint8_t> into) {
  choose(address);
  if (::read(descriptor_, into.data(), into.size()) != static_cast<ssize_t>(into.size())) {
    throw InputError(path_ + ": the device at address " + std::to_string(int{address}) + " stopped answering");
  }
}

}  // namespace fathom::link

// A device on an I2C bus of the host (/dev/i2c-N).
#pragma once

#include <string>

#include "common/devices/ms5837.hpp"

namespace fathom::link {

class LinuxI2c final : public devices::I2cBus {
 public:
  /// InputError when there is no such bus or no permission.
  explicit LinuxI2c(std::string path);
  ~LinuxI2c() override;
  LinuxI2c(const LinuxI2c&) = delete;
  LinuxI2c& operator=(const LinuxI2c&) = delete;

  void write(std::uint8_t address, std::uint8_t command) override;
  void read(std::uint8_t address, std::span<std::uint8_t> into) override;

 private:
  void choose(std::uint8_t address);

  std::string path_;
  int descriptor_;
};

}  // namespace fathom::link

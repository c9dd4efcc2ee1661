// Depth from an MS5837 on an I2C bus: asked, not listening, so it has no line and no parser.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/base/time.hpp"
#include "common/devices/ms5837.hpp"
#include "common/driver/lever_arm.hpp"
#include "common/driver/watch.hpp"

namespace fathom {
class Config;
namespace runtime {
class Process;
}
}  // namespace fathom

namespace fathom::driver {

class PressureSensor {
 public:
  PressureSensor(runtime::Process& process, const Config& config);

 private:
  void wait(std::span<const int> descriptors, int milliseconds);
  void measure();
  void lose(const std::string& why);

  runtime::Process& process_;
  std::string path_;
  devices::ms5837::Model model_;
  double period_, latency_, density_, gravity_, air_pressure_;
  LeverArm arm_;
  Watch watch_;
  std::unique_ptr<devices::I2cBus> bus_;
  std::optional<devices::ms5837::Sensor> sensor_;
  double next_{}, pause_;
  std::uint64_t readings_{}, lost_{};
  std::string said_;
};

}  // namespace fathom::driver

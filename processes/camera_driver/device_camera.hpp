// A camera of this host (`device: /dev/video0`): its pictures, stamped with the time of their exposure.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "common/pictures/camera.hpp"
#include "common/runtime/process.hpp"
#include "processes/camera_driver/arrival_stamps.hpp"

namespace fathom {
class Config;
}

namespace fathom::camera_driver {

struct DeviceSettings {
  std::string camera;
  pictures::CameraSettings device;
  bool kernel_stamps{false};
  double latency{};  ///< s from the middle of the exposure to the kernel's stamp, or else to the picture's arrival
  int quality{90};   ///< of JPEG, where the camera makes none itself

  [[nodiscard]] static DeviceSettings from(const Config& config);
};

class DeviceCamera {
 public:
  /// InputError when there is no such camera.
  DeviceCamera(runtime::Process& process, DeviceSettings settings);
  void wait(std::span<const int> descriptors, int milliseconds);
  [[nodiscard]] runtime::Process::Condition condition() const;

 private:
  void publish(pictures::Frame frame);
  void leave_out(const std::string& why);
  void lost(const std::string& why);
  void try_again(std::span<const int> descriptors, int milliseconds);

  runtime::Process& process_;
  DeviceSettings settings_;
  std::unique_ptr<pictures::Camera> camera_;
  ArrivalStamps stamps_;
  std::string complaint_;
  double last_{}, last_try_{};  ///< s of the newest picture, and of the last attempt to open
  double age_{};                ///< s from the kernel's stamp to arrival, of the newest picture
  bool silent_{false}, lost_{false};
  std::int64_t count_{}, unreadable_{};
};

}  // namespace fathom::camera_driver

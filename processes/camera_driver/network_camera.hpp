// A camera on the network that sends one JPEG behind the other over TCP (`device: tcp://HOST:PORT`).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/link/link.hpp"
#include "common/runtime/process.hpp"
#include "common/vision/jpeg_stream.hpp"
#include "processes/camera_driver/arrival_stamps.hpp"

namespace fathom::camera_driver {

struct NetworkSettings {
  std::string camera;
  link::Endpoint endpoint;
  double latency{};            ///< s from the exposure to a picture's first bytes
  std::optional<double> rate;  ///< Hz, kept by the camera: pictures that come late are stamped when they were taken
};

class NetworkCamera {
 public:
  NetworkCamera(runtime::Process& process, NetworkSettings settings);
  void wait(std::span<const int> descriptors, int milliseconds);
  [[nodiscard]] runtime::Process::Condition condition() const;

 private:
  void received(std::span<const std::uint8_t> bytes, Utime arrival);
  void changed(bool up, const std::string& why);
  void publish(std::vector<std::uint8_t> jpeg);

  runtime::Process& process_;
  NetworkSettings settings_;
  vision::JpegStream stream_;
  ArrivalStamps stamps_;
  std::string why_{"the line is not open yet"}, complaint_;
  Utime begun_{};       ///< arrival of the first bytes of the picture that is coming
  double last_{};       ///< s of the newest picture, or since the line came up
  bool silent_{false};  ///< said
  std::int64_t count_{}, unreadable_{};
  link::Link link_;
};

}  // namespace fathom::camera_driver

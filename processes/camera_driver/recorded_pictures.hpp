// Recorded pictures (`pictures:` a folder or a video) at the pace at which they were taken.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "common/pictures/source.hpp"
#include "common/runtime/process.hpp"

namespace fathom {
class Config;
}

namespace fathom::camera_driver {

struct RecordedSettings {
  std::string camera, pictures;
  double rate{0.0}, speed{1.0};  ///< Hz, 0: what the video says; times real time
  int quality{90};               ///< of JPEG
  bool repeat{false};

  [[nodiscard]] static RecordedSettings from(const Config& config);
};

class RecordedPictures {
 public:
  RecordedPictures(runtime::Process& process, RecordedSettings settings);
  void wait(std::span<const int> descriptors, int milliseconds);
  [[nodiscard]] runtime::Process::Condition condition() const;

 private:
  void publish(pictures::Frame& frame);

  runtime::Process& process_;
  RecordedSettings settings_;
  std::unique_ptr<pictures::Source> source_;
  std::string complaint_, remark_;
  std::int64_t count_{}, unreadable_{};
  std::chrono::steady_clock::time_point began_{};
  Utime first_{};
  double due_{}, offset_{};  ///< s since the first picture
};

}  // namespace fathom::camera_driver

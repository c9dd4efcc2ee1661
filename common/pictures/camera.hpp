// A camera of this host (V4L2, by OpenCV).
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/pictures/source.hpp"

namespace fathom::pictures {

struct CameraSettings {
  std::string device;      ///< "/dev/video0"
  int width{}, height{};   ///< px; 0: what the camera likes
  double rate{};           ///< Hz; 0: what the camera likes
  std::string format;      ///< four letters, as V4L2 names them; MJPG is handed on as it comes. Empty: OpenCV's choice
  bool newest_only{true};  ///< the driver keeps one picture, not four: they are stamped as they are read
};

class Camera {
 public:
  virtual ~Camera() = default;
  /// False: no picture yet after so many seconds. InputError when the camera is gone.
  virtual bool wait(double seconds) = 0;
  /// The picture that is there. InputError as above.
  virtual Frame read() = 0;
  /// "640 x 480, YUYV"
  [[nodiscard]] virtual std::string description() const = 0;
};

/// InputError when there is none, somebody else has it, or it cannot do what is asked.
[[nodiscard]] std::unique_ptr<Camera> open_camera(const CameraSettings& settings);

/// How long ago the kernel stamped a picture [s]; below zero: it is ahead of the clock. Drivers stamp by the monotonic
/// clock, old ones by the clock on the wall; nothing where the stamp fits neither.
[[nodiscard]] std::optional<double> age_of_stamp(double stamp, double monotonic, double wall);

}  // namespace fathom::pictures

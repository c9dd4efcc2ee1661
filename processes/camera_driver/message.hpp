// A picture as a message.
#pragma once

#include <string>
#include <utility>

#include "common/pictures/source.hpp"
#include "common/samples/vision.hpp"
#include "common/vision/jpeg.hpp"

namespace fathom::camera_driver {

/// `utime`: of the exposure. The frame's own JPEG where it has one, else one of `quality`.
[[nodiscard]] inline Camera as_message(pictures::Frame frame, Utime utime, const std::string& camera, int quality) {
  Camera sample{.utime = utime, .camera = camera, .width = frame.picture.cols, .height = frame.picture.rows};
  sample.jpeg =
      frame.jpeg.empty() ? vision::encode_jpeg(frame.picture, quality, frame.halved_colour) : std::move(frame.jpeg);
  return sample;
}

}  // namespace fathom::camera_driver

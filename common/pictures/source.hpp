// Pictures from a folder or a video file, one after the other.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace fathom::pictures {

struct Frame {
  std::string name;                ///< the file's, or six digits of a video's count
  double time{};                   ///< s since the first picture
  cv::Mat picture;                 ///< 8 bit, grey or colour in OpenCV's order; empty when `problem` says why
  bool halved_colour{false};       ///< colour has half the resolution of brightness
  Utime arrival{};                 ///< when it was read; of a camera's pictures alone, as is
  std::optional<double> age;       ///< s since the kernel stamped it, at arrival (age_of_stamp)
  std::string problem;             ///< one line; empty when all is well
  std::vector<std::uint8_t> jpeg;  ///< the file's own bytes, where it is a JPEG
};

class Source {
 public:
  virtual ~Source() = default;
  /// Nothing: the end.
  virtual std::optional<Frame> next() = 0;
  [[nodiscard]] virtual double rate() const = 0;  ///< Hz
  /// Pictures that are still to come, as far as that is known; for telling how long it will take.
  [[nodiscard]] virtual double to_come() const { return 0.0; }
  /// What was odd of all of it, known at its end; one line, mostly empty.
  [[nodiscard]] virtual std::string remark() const { return {}; }
};

/// Folder (its pictures in the order of their names, numbers by value), single picture, or video. `rate` [Hz]: of a
/// folder's pictures, or instead of what a video says; 0: what the video says, 10 Hz for a folder. InputError when
/// there is nothing to read.
[[nodiscard]] std::unique_ptr<Source> open(const std::string& path, double rate);

/// 8 bit, one or three channels. `bits`: of the largest brightness, where a pixel has 16.
[[nodiscard]] cv::Mat plain(const cv::Mat& picture, int bits = 16);

/// The picture itself when it is grey.
[[nodiscard]] cv::Mat in_grey(const cv::Mat& picture);

/// PNG or JPEG by the name's end; InputError when it cannot be written.
void write(const std::string& path, const cv::Mat& picture);

}  // namespace fathom::pictures

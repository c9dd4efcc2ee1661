// JPEG by libjpeg itself: a damaged file is told as such, where others hand out half a picture.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

namespace fathom::vision {

/// Decodes to grey, and to colour (OpenCV's order) where wanted and present; else `bgr` is empty. Returns "" when all
/// is well, else what is wrong: nothing may be read from the picture then.
[[nodiscard]] std::string decode_jpeg(std::span<const std::uint8_t> bytes, bool colour, cv::Mat& grey, cv::Mat& bgr);

/// `picture`: grey or colour in OpenCV's order, 8 bit.
[[nodiscard]] std::vector<std::uint8_t> encode_jpeg(const cv::Mat& picture, int quality);

}  // namespace fathom::vision

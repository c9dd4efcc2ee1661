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

/// Whether colour has less resolution than brightness, as cameras mostly send it (4:2:0, 4:2:2). False for what is no
/// JPEG.
[[nodiscard]] bool halves_colour(std::span<const std::uint8_t> bytes);

/// `picture`: grey or colour in OpenCV's order, 8 bit. `halved_colour`: it has no more than that (4:2:2), and the file
/// says so.
[[nodiscard]] std::vector<std::uint8_t> encode_jpeg(const cv::Mat& picture, int quality, bool halved_colour = false);

}  // namespace fathom::vision

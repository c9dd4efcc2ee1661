// Light multiplies: its logarithm adds.
#pragma once

#include <cmath>
#include <opencv2/core/mat.hpp>

namespace fathom::vision {

/// For cv::LUT: the logarithm of each brightness, from a little above black, where noise is all there is.
inline const cv::Mat& logarithms() {
  static const cv::Mat table = [] {
    constexpr float kBlack = 8.0F;
    cv::Mat values(1, 256, CV_32FC1);
    for (int i = 0; i < 256; ++i) values.at<float>(i) = std::log(static_cast<float>(i) + kBlack);
    return values;
  }();
  return table;
}

}  // namespace fathom::vision

// A picture of a calibration: what is left of every corner, and the map.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/vision/calibration.hpp"

namespace fathom::vision {

/// Left: the picture's plane with each corner's error, drawn many times larger, before (grey) and after (orange).
/// Right: the map from above, tags before and after, and where the cameras were.
[[nodiscard]] cv::Mat draw_calibration(const Calibration& calibration, const model::Site& before);

}  // namespace fathom::vision

// The middle of a bright spot in a grey picture, to a fraction of a pixel.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace fathom::vision {

struct BrightSpot {
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};
  double sigma{};   ///< px, along either axis: what the surroundings' unevenness can move it
  double height{};  ///< brightness above the surroundings, mean over the window
};

/// Centroid under a Gaussian window that follows it, from `start` on (Bertin and Arnouts 1996, SExtractor's
/// XWIN_IMAGE). `window`: px, its standard deviation; nothing when it wanders farther than `reach` px, finds nothing
/// bright or comes to the picture's border.
[[nodiscard]] std::optional<BrightSpot> find_bright_spot(const cv::Mat& grey, const Eigen::Vector2d& start,
                                                         double window, double reach);

}  // namespace fathom::vision

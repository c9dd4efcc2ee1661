// A rendered tank for the tests of vision: the truth of everything that a picture shows.
#pragma once

#include <opencv2/core.hpp>

#include "common/base/spatial.hpp"
#include "common/vision/front_end.hpp"
#include "common/vision/renderer.hpp"

namespace fathom::vision::test_scene {

inline model::Lens lens() { return {.width = 640, .height = 480, .fx = 540, .fy = 540, .cx = 319.5, .cy = 239.5}; }

inline model::LaserMount laser() { return {.camera = "down", .p_CE = {0.06, 0.0, 0.0}}; }

/// Twenty-five tags on a floor 1.5 m below the surface.
inline model::Site site(const std::string& family = "tag36h11") {
  model::Site site;
  site.name = "rendered";
  site.floor = 1.5;
  site.search.families = {family};
  site.search.map_sigma = 0.0;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 5; ++column) {
      site.tags.push_back({.id = 5 * row + column, .size = 0.15, .p_WT = {0.45 * (column - 2), 0.45 * (row - 2), 1.5}});
    }
  }
  return site;
}

/// A camera that looks down, turned and tilted [rad], at `p_WC` [m].
inline Pose pose(const Eigen::Vector3d& p_WC, double roll = 0.0, double pitch = 0.0, double yaw = 0.0) {
  return {.p_WC = p_WC, .R_WC = rotation_from_euler({roll, pitch, yaw})};
}

inline cv::Mat grey_of(const cv::Mat& bgr) {
  cv::Mat grey(bgr.size(), CV_8UC1);
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      const auto& c = bgr.at<cv::Vec3b>(y, x);
      grey.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(0.114 * c[0] + 0.587 * c[1] + 0.299 * c[2]);
    }
  }
  return grey;
}

inline Picture picture(Renderer& renderer, double t, const Pose& pose) {
  const cv::Mat bgr = renderer.step(t, pose).clone();
  return {.utime = utime_after(1'000'000, t), .grey = grey_of(bgr), .bgr = bgr};
}

}  // namespace fathom::vision::test_scene

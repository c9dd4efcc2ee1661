#include "common/vision/calibration_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace fathom::vision {
namespace {

const cv::Scalar kInk{60, 50, 40}, kPale{200, 195, 190}, kBefore{170, 160, 150}, kAfter{20, 110, 235},
    kPath{190, 130, 40};

void label(cv::Mat& picture, const std::string& text, cv::Point at, double size = 0.5) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

cv::Point at(double x, double y) { return {static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))}; }

}  // namespace

cv::Mat draw_calibration(const Calibration& calibration, const model::Site& before) {
  constexpr int kSide = 640, kHead = 40, kGap = 20;
  constexpr double kLarger = 20.0;
  const model::Lens& lens = *calibration.site.lens;
  cv::Mat picture(kSide + kHead, 2 * kSide + kGap, CV_8UC3, cv::Scalar{252, 252, 252});
  const double scale = static_cast<double>(kSide) / std::max(lens.width, lens.height);
  cv::rectangle(picture, at(0, kHead), at(lens.width * scale, kHead + lens.height * scale), kPale);
  char text[160];
  std::snprintf(text, sizeof text, "errors x %.0f: before %.2f px (grey), after %.2f px (orange)", kLarger,
                calibration.before.median, calibration.after.median);
  label(picture, text, {6, 24});
  const auto arrows = [&](const Reprojection& error, const cv::Scalar& colour) {
    for (const Residual& each : error.residuals) {
      const Eigen::Vector2d from = scale * each.pixel, to = from + scale * kLarger * each.error;
      cv::line(picture, at(from.x(), from.y() + kHead), at(to.x(), to.y() + kHead), colour, 1, cv::LINE_AA);
    }
  };
  arrows(calibration.before, kBefore);
  arrows(calibration.after, kAfter);

  Eigen::Vector2d low{1e9, 1e9}, high{-1e9, -1e9};
  const auto stretch = [&](const Eigen::Vector3d& p) {
    low = low.cwiseMin(p.head<2>());
    high = high.cwiseMax(p.head<2>());
  };
  for (const model::Tag& tag : calibration.site.tags) stretch(tag.p_WT);
  for (const Residual& each : calibration.after.residuals) stretch(calibration.after.poses[each.view].p_WC);
  const double room = std::max({high.x() - low.x(), high.y() - low.y(), 0.1}) * 1.2;
  const Eigen::Vector2d middle = 0.5 * (low + high);
  const auto on_map = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector2d q = (p.head<2>() - middle) * kSide / room;
    return at(kSide + kGap + 0.5 * kSide + q.x(), kHead + 0.5 * kSide + q.y());
  };
  std::snprintf(text, sizeof text, "map from above, %.1f m wide: tags before (grey), after; cameras (blue)", room);
  label(picture, text, {kSide + kGap, 24});
  const auto tags = [&](const model::Site& site, const cv::Scalar& colour, bool named) {
    for (const model::Tag& tag : site.tags) {
      const double h = 0.5 * tag.size;
      const std::array<Eigen::Vector3d, 4> corners{{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
      for (std::size_t i = 0; i < 4; ++i) {
        cv::line(picture, on_map(tag.p_WT + tag.R_WT * corners[i]), on_map(tag.p_WT + tag.R_WT * corners[(i + 1) % 4]),
                 colour, 1, cv::LINE_AA);
      }
      if (named) label(picture, std::to_string(tag.id), on_map(tag.p_WT), 0.4);
    }
  };
  tags(before, kBefore, false);
  tags(calibration.site, kAfter, true);
  for (const Residual& each : calibration.after.residuals) {
    cv::circle(picture, on_map(calibration.after.poses[each.view].p_WC), 2, kPath, cv::FILLED, cv::LINE_AA);
  }
  return picture;
}

}  // namespace fathom::vision

#include "common/vision/flow/features.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom::vision {

// The smaller eigenvalue of the products of slopes, summed over three by three pixels; 0 at the border.
void Features::measure(const cv::Mat& grey) {
  using Slopes = Eigen::Map<const Eigen::Array<std::int16_t, Eigen::Dynamic, 1>>;
  cv::spatialGradient(grey, slope_x_, slope_y_);
  const Eigen::Index width = grey.cols, inner = width - 2;
  texture_.create(grey.size(), CV_32FC1);
  texture_.setTo(0.0);
  for (Eigen::ArrayXXf* each : {&by_x_, &by_both_, &by_y_}) each->resize(width, 3);
  for (int y = 0; y < grey.rows; ++y) {
    const Slopes slope_x{slope_x_.ptr<std::int16_t>(y), width}, slope_y{slope_y_.ptr<std::int16_t>(y), width};
    x_ = slope_x.cast<float>();
    y_ = slope_y.cast<float>();
    by_x_.col(y % 3) = x_.square();
    by_both_.col(y % 3) = x_ * y_;
    by_y_.col(y % 3) = y_.square();
    if (y < 2) continue;
    x_ = by_x_.col(0) + by_x_.col(1) + by_x_.col(2);
    both_ = by_both_.col(0) + by_both_.col(1) + by_both_.col(2);
    y_ = by_y_.col(0) + by_y_.col(1) + by_y_.col(2);
    const auto three = [inner](const Eigen::ArrayXf& sums, Eigen::ArrayXf& to) {
      to = sums.head(inner) + sums.segment(1, inner) + sums.tail(inner);
    };
    three(x_, a_);
    three(both_, b_);
    three(y_, c_);
    Eigen::Map<Eigen::ArrayXf>{texture_.ptr<float>(y - 1) + 1, inner} =
        (a_ + c_) - ((a_ - c_).square() + 4.0F * b_.square()).sqrt();
  }
}

void Features::look(const cv::Mat& grey, const cv::Mat& mask) {
  mask_ = mask;
  if (grey.cols < 3 || grey.rows < 3) {
    texture_.release();
    return;
  }
  measure(grey);
  double best = 0.0;
  cv::minMaxLoc(texture_, nullptr, &best, nullptr, nullptr, mask);
  best_ = static_cast<float>(best);
  cv::dilate(texture_, largest_, {});
}

void Features::choose(double quality, double apart, std::size_t most, std::vector<cv::Point2f>& chosen) {
  chosen.clear();
  candidates_.clear();
  const float least = static_cast<float>(quality) * best_;
  for (int y = 1; y + 1 < texture_.rows; ++y) {
    const auto *value = texture_.ptr<float>(y), *largest = largest_.ptr<float>(y);
    for (int x = 1; x + 1 < texture_.cols; ++x) {
      if (value[x] <= least || value[x] != largest[x]) continue;
      if (mask_.empty() || mask_.at<std::uint8_t>(y, x) != 0) candidates_.push_back({value[x], x, y});
    }
  }
  const auto worse = [](const Candidate& a, const Candidate& b) {
    if (a.value != b.value) return a.value < b.value;
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  };
  // Cells as large as points are apart: those that are too near lie in the same one or beside it.
  const int side = std::max(static_cast<int>(std::ceil(apart)), 1);
  const int across = (texture_.cols + side - 1) / side + 2, down = (texture_.rows + side - 1) / side + 2;
  cells_.resize(static_cast<std::size_t>(across * down));
  for (auto& cell : cells_) cell.clear();
  const auto near = static_cast<float>(apart * apart);
  std::make_heap(candidates_.begin(), candidates_.end(), worse);
  for (auto end = candidates_.end(); end != candidates_.begin() && chosen.size() < most; --end) {
    std::pop_heap(candidates_.begin(), end, worse);
    const cv::Point2f at{static_cast<float>((end - 1)->x), static_cast<float>((end - 1)->y)};
    const int cell = ((end - 1)->y / side + 1) * across + (end - 1)->x / side + 1;
    const auto crowds = [&](const cv::Point2f& other) {
      const cv::Point2f between = other - at;
      return between.dot(between) < near;
    };
    bool free = true;
    for (const int row : {cell - across, cell, cell + across}) {
      for (int i = row - 1; i <= row + 1 && free; ++i) {
        free = std::ranges::none_of(cells_[static_cast<std::size_t>(i)], crowds);
      }
    }
    if (!free) continue;
    cells_[static_cast<std::size_t>(cell)].push_back(at);
    chosen.push_back(at);
  }
}

}  // namespace fathom::vision

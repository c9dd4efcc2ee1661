#include "common/vision/flow/steady_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/logarithm.hpp"

namespace fathom::vision {
namespace {

constexpr double kApart = 10.0;       // px: detail of one picture has nothing to do with that of the other
constexpr int kSeldom = 3;            // pictures, for speed
constexpr int kLeast = 10;            // pictures before anything is said
constexpr std::size_t kMemory = 100;  // pictures: a window is wiped, a clock's digits change
constexpr double kMost = 0.3;  // of a logarithm, by one picture: an edge of a tag has 2, and would be seen for long
constexpr double kSure = 5.0;  // standard errors of a mean
constexpr int kWide = 9;       // px: what is coarser is light

}  // namespace

bool SteadyPattern::known() const { return n_ >= kLeast; }

void SteadyPattern::take_out(const cv::Mat& grey, cv::Mat& clean) {
  if (any_ && gain_.size() == grey.size()) {
    cv::multiply(grey, gain_, clean, 1.0, CV_8U);
  } else {
    grey.copyTo(clean);
  }
}

void SteadyPattern::learn(const cv::Mat& grey, const Eigen::Vector2d& moved) {
  at_ += moved;
  if (++since_ < kSeldom) return;
  // Who hovers sees a few pieces of floor again and again, and their mean is the floor.
  const auto near = [this](const Eigen::Vector2d& place) { return (at_ - place).norm() < kApart; };
  if (std::ranges::any_of(places_, near)) return;
  places_.push_back(at_);
  if (places_.size() > kMemory) places_.pop_front();
  since_ = 0;
  if (mean_.size() != grey.size()) {
    mean_ = cv::Mat::zeros(grey.size(), CV_32FC1);
    places_.assign(1, at_);
    n_ = 0;
    any_ = false;
  }
  n_ = std::min(n_ + 1, static_cast<int>(kMemory));
  cv::LUT(grey, logarithms(), detail_);
  cv::blur(detail_, blurred_, {kWide, kWide});
  cv::subtract(detail_, blurred_, detail_);
  cv::subtract(detail_, mean_, detail_);
  cv::min(detail_, kMost, detail_);
  cv::max(detail_, -kMost, detail_);
  cv::scaleAdd(detail_, 1.0 / n_, mean_, mean_);
  spread_ += (cv::norm(detail_) / std::sqrt(static_cast<double>(grey.total())) - spread_) / n_;
  if (n_ >= kLeast) judge();
}

// What of the mean is more than chance.
void SteadyPattern::judge() {
  const auto least = static_cast<float>(kSure * spread_ / std::sqrt(static_cast<double>(n_)));
  gain_.create(mean_.size(), CV_32FC1);
  any_ = false;
  for (int y = 0; y < mean_.rows; ++y) {
    const auto* from = mean_.ptr<float>(y);
    auto* to = gain_.ptr<float>(y);
    for (int x = 0; x < mean_.cols; ++x) {
      const bool steady = std::abs(from[x]) > least;
      to[x] = steady ? std::exp(-from[x]) : 1.0F;
      any_ = any_ || steady;
    }
  }
}

}  // namespace fathom::vision

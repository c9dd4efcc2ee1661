#include "common/vision/flow/fine_shift.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/logarithm.hpp"

namespace fathom::vision {
namespace {

constexpr double kShare = 0.6;                     // of the picture that is looked at
constexpr int kLongest = 640;                      // px
constexpr double kCoarsest = 0.06, kFinest = 0.3;  // cycles per px: above, interpolation and a coder leave little
constexpr int kReach = 2;                          // px, half of a peak's width
// Strengths. Of 50 000 places one in 10^7 pictures is so high by chance; of the nine where the floor is expected, one
// in 10^5. A floor that rests while light moves over it is seen in nearly all phases.
constexpr double kSure = 7.0, kAgreeing = 5.0, kRests = 20.0;
constexpr double kAsStrong = 0.5;  // as what moves with the camera, and believed in its place
constexpr double kLeft = 0.2;      // the same where the floor is expected and little that is steady can be left

}  // namespace

void FineShift::prepare(cv::Size size) {
  // The middle of the picture, of a size that is quick to transform; windows take its borders out anyway.
  const auto length = [](int whole) {
    int best = 2;
    for (int n = 2; n <= std::min(static_cast<int>(kShare * whole), kLongest); n += 2) {
      if (cv::getOptimalDFTSize(n) == n) best = n;
    }
    return best;
  };
  const cv::Size part{length(size.width), length(size.height)};
  part_ = cv::Rect{cv::Point{(size.width - part.width) / 2, (size.height - part.height) / 2}, part};
  cv::createHanningWindow(window_, part, CV_32FC1);
  band_.create(part.height, part.width / 2, CV_32FC1);  // of one half of the spectrum; the other is its mirror
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width / 2; ++x) {
      const double v = std::min(y, part.height - y) / static_cast<double>(part.height);
      const double f = std::hypot(x / static_cast<double>(part.width), v);
      const double place = (f - kCoarsest) / (kFinest - kCoarsest);
      const bool within = x > 0 && place > 0.0 && place < 1.0;
      band_.at<float>(y, x) = within ? static_cast<float>(std::sin(M_PI * place)) : 0.0F;
    }
  }
}

void FineShift::look(const cv::Mat& grey, const cv::Mat& weight) {
  std::swap(now_, before_);
  std::swap(detail_, detail_before_);
  if (size_ != grey.size()) {
    size_ = grey.size();
    prepare(size_);
    before_.release();
  }
  cv::LUT(grey, logarithms(), detail_);
  constexpr int kWide = 9;  // px
  cv::blur(detail_, surroundings_, {kWide, kWide});
  const double brightness = std::exp(cv::mean(surroundings_)[0]);
  cv::addWeighted(detail_, brightness, surroundings_, -brightness, 0.0, detail_);
  // Contrast of regions of 28 px, at a quarter of the resolution, for it is smooth.
  constexpr int kCoarser = 4, kRegion = 7;
  cv::multiply(detail_, detail_, surroundings_);
  const cv::Size coarse{(grey.cols + kCoarser - 1) / kCoarser, (grey.rows + kCoarser - 1) / kCoarser};
  cv::resize(surroundings_, squares_, coarse, 0.0, 0.0, cv::INTER_AREA);
  cv::blur(squares_, contrast_, {kRegion, kRegion});
  const double nothing = 0.01 * brightness;
  cv::add(contrast_, nothing * nothing, contrast_);
  cv::sqrt(contrast_, contrast_);
  cv::resize(contrast_, surroundings_, grey.size(), 0.0, 0.0, cv::INTER_LINEAR);
  cv::divide(detail_, surroundings_, now_);
  if (!weight.empty()) cv::multiply(now_, weight, now_);
}

void FineShift::transform(const cv::Mat& from, cv::Mat& to) {
  cv::multiply(from, window_, tapered_);
  cv::dft(tapered_, to);
}

// Peaks of the correlation of phases, at the shifts of this picture against where it was expected.
void FineShift::correlate(const cv::Mat& origin) {
  cv::remap(before_, expected_, origin(part_), cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  transform(expected_, spectrum_before_);
  transform(now_(part_), spectrum_now_);
  product_.create(part_.size(), CV_32FC1);
  product_.setTo(0.0);
  double squares = 0.0;
  for (int y = 0; y < part_.height; ++y) {  // packed: real and imaginary parts of a frequency at 2 x - 1 and 2 x
    const float* a = spectrum_before_.ptr<float>(y);
    const float* b = spectrum_now_.ptr<float>(y);
    const float* weight = band_.ptr<float>(y);
    float* to = product_.ptr<float>(y);
    const int last = static_cast<int>(kFinest * part_.width);
    for (int x = 1; x <= last; ++x) {
      if (weight[x] == 0.0F) continue;
      const int i = 2 * x - 1;
      const float re = b[i] * a[i] + b[i + 1] * a[i + 1], im = b[i + 1] * a[i] - b[i] * a[i + 1];
      const float size = std::sqrt(re * re + im * im);
      if (!(size > 0.0F)) continue;
      to[i] = weight[x] * re / size;
      to[i + 1] = weight[x] * im / size;
      squares += static_cast<double>(weight[x] * weight[x]);
    }
  }
  cv::dft(product_, peaks_, cv::DFT_INVERSE);
  // Were all phases chance, each of the two mirrored halves would add a half to a variance.
  chance_ = std::sqrt(std::max(2.0 * squares, 1.0));
}

float FineShift::value(cv::Point at) const {
  return peaks_.at<float>((at.y + peaks_.rows) % peaks_.rows, (at.x + peaks_.cols) % peaks_.cols);
}

FineMotion FineShift::peak(cv::Point at) const {
  const auto between = [](float left, float middle, float right) {
    const float bend = left - 2.0F * middle + right;
    return bend < 0.0F ? std::clamp(0.5 * static_cast<double>((left - right) / bend), -1.0, 1.0) : 0.0;
  };
  const float middle = value(at);
  FineMotion found{.strength = middle / chance_};
  found.shift = {at.x + between(value({at.x - 1, at.y}), middle, value({at.x + 1, at.y})),
                 at.y + between(value({at.x, at.y - 1}), middle, value({at.x, at.y + 1}))};
  if (found.shift.x() > 0.5 * peaks_.cols) found.shift.x() -= peaks_.cols;
  if (found.shift.y() > 0.5 * peaks_.rows) found.shift.y() -= peaks_.rows;
  return found;
}

FineMotion FineShift::highest() const {
  cv::Point at;
  cv::minMaxLoc(peaks_, nullptr, nullptr, nullptr, &at);
  return peak(at);
}

FineMotion FineShift::highest_near(cv::Point place, int reach) const {
  cv::Point at = place;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const cv::Point here{place.x + x, place.y + y};
      if (value(here) > value(at)) at = here;
    }
  }
  return peak(at);
}

void FineShift::take_out_near(cv::Point place, int reach) {
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const cv::Point at{place.x + x, place.y + y};
      peaks_.at<float>((at.y + peaks_.rows) % peaks_.rows, (at.x + peaks_.cols) % peaks_.cols) = 0.0F;
    }
  }
}

std::optional<FineMotion> FineShift::find(const cv::Mat& origin, bool steady_known) {
  if (before_.empty()) return {};
  correlate(origin);
  const FineMotion top = highest();
  if (!(top.strength > kSure)) return {};
  const cv::Point middle{part_.x + part_.width / 2, part_.y + part_.height / 2};
  const auto& from = origin.at<cv::Vec2f>(middle);
  const Eigen::Vector2d fixed{from[0] - static_cast<float>(middle.x), from[1] - static_cast<float>(middle.y)};
  const auto is_fixed = [&](const Eigen::Vector2d& shift) {
    return (shift - fixed).lpNorm<Eigen::Infinity>() <= kReach + 0.5;
  };
  if (!fixed.allFinite() || !is_fixed(top.shift)) return top;
  // The floor rests, or what moves with the camera is stronger than what is left of the floor.
  const bool expected = is_fixed(Eigen::Vector2d::Zero());
  if (!expected) {
    const FineMotion own = highest_near({0, 0}, 1);
    if (own.strength > std::max(kAgreeing, steady_known ? kLeft * top.strength : 0.0)) return own;
  }
  for (const Eigen::Vector2d& place : {fixed, top.shift})
    take_out_near({cvRound(place.x()), cvRound(place.y())}, kReach);
  const FineMotion other = highest();
  if (other.strength > kAsStrong * top.strength) return other;
  if (expected || (steady_known && top.strength > kRests)) return top;
  return {};
}

}  // namespace fathom::vision

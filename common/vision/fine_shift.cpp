#include "common/vision/fine_shift.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom::vision {
namespace {

constexpr double kShare = 0.6;                     // of the picture that is looked at
constexpr int kLongest = 640;                      // px
constexpr double kCoarsest = 0.06, kFinest = 0.3;  // cycles per px: above, interpolation and a coder leave little

// Light multiplies: its logarithm adds.
const cv::Mat& logarithms() {
  static const cv::Mat table = [] {
    cv::Mat values(1, 256, CV_32FC1);
    for (int i = 0; i < 256; ++i) values.at<float>(i) = std::log(static_cast<float>(i) + 8.0F);
    return values;
  }();
  return table;
}

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

void FineShift::look(const cv::Mat& grey) {
  std::swap(now_, before_);
  if (size_ != grey.size()) {
    size_ = grey.size();
    prepare(size_);
    before_.release();
  }
  cv::LUT(grey, logarithms(), now_);
  constexpr int kWide = 9, kRegion = 25;  // px
  cv::blur(now_, blurred_, {kWide, kWide});
  cv::subtract(now_, blurred_, now_);
  cv::multiply(now_, now_, blurred_);
  cv::blur(blurred_, blurred_, {kRegion, kRegion});
  constexpr double kNothing = 1e-4;  // square of a contrast of 1 %
  cv::add(blurred_, kNothing, blurred_);
  cv::sqrt(blurred_, blurred_);
  cv::divide(now_, blurred_, now_);
}

void FineShift::transform(const cv::Mat& from, cv::Mat& to) {
  cv::multiply(from, window_, tapered_);
  cv::dft(tapered_, to);
}

std::optional<FineMotion> FineShift::find(const cv::Mat& origin) {
  if (before_.empty()) return {};
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
  double top = 0.0;
  cv::Point at;
  cv::minMaxLoc(peaks_, nullptr, &top, nullptr, &at);
  const auto wrapped = [&](int x, int y) {
    return peaks_.at<float>((y + peaks_.rows) % peaks_.rows, (x + peaks_.cols) % peaks_.cols);
  };
  const auto between = [](float left, float middle, float right) {
    const float bend = left - 2.0F * middle + right;
    return bend < 0.0F ? 0.5 * static_cast<double>((left - right) / bend) : 0.0;
  };
  // Were all phases chance, each of the two mirrored halves would add a half to a variance.
  FineMotion found{.strength = top / std::sqrt(std::max(2.0 * squares, 1.0))};
  const float middle = wrapped(at.x, at.y);
  found.shift = {at.x + between(wrapped(at.x - 1, at.y), middle, wrapped(at.x + 1, at.y)),
                 at.y + between(wrapped(at.x, at.y - 1), middle, wrapped(at.x, at.y + 1))};
  if (found.shift.x() > 0.5 * peaks_.cols) found.shift.x() -= peaks_.cols;
  if (found.shift.y() > 0.5 * peaks_.rows) found.shift.y() -= peaks_.rows;
  return found;
}

}  // namespace fathom::vision

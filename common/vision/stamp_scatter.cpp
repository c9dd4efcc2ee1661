#include "common/vision/stamp_scatter.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::vision {
namespace {

constexpr std::size_t kMost = 31, kFew = 15;  // stamps
constexpr double kExact = 2e-6;               // s: stamps are rounded

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

// What intervals miss multiples of the usual one by: pictures that were left out change nothing.
void StampScatter::step(Utime utime) {
  stamps_.push_back(utime);
  if (stamps_.size() > kMost) stamps_.pop_front();
  if (stamps_.size() < kFew) {
    sigma_ = 0.0;
    return;
  }
  const auto intervals = [&] {
    sorted_.clear();
    for (std::size_t i = 1; i < stamps_.size(); ++i) sorted_.push_back(seconds_between(stamps_[i - 1], stamps_[i]));
  };
  intervals();
  interval_ = median(sorted_);
  intervals();
  for (double& each : sorted_) {
    each = std::abs(each - interval_ * std::max(std::round(each / interval_), 1.0));
  }
  const double missed = 1.4826 * median(sorted_);  // as a standard deviation; of two stamps
  sigma_ = missed > kExact ? missed / std::sqrt(2.0) : 0.0;
}

}  // namespace fathom::vision

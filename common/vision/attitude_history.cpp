#include "common/vision/attitude_history.hpp"

#include <algorithm>

#include "common/base/spatial.hpp"

namespace fathom::vision {
namespace {

constexpr double kMemory = 2.0;       // s: pictures are not older
constexpr double kLargestGap = 0.25;  // s between two samples
constexpr double kFarthest = 0.05;    // s ahead of the last sample, with its rates

}  // namespace

void AttitudeHistory::hear(const Ahrs& sample) {
  if (!sample.has_attitude) return;
  if (!samples_.empty() && sample.utime <= samples_.back().utime) return;
  samples_.push_back(sample);
  while (seconds_between(samples_.front().utime, sample.utime) > kMemory) samples_.pop_front();
}

std::optional<Eigen::Quaterniond> AttitudeHistory::at(Utime utime) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), utime,
                                      [](const Ahrs& sample, Utime t) { return sample.utime < t; });
  if (after == samples_.end()) {
    if (samples_.empty()) return {};
    const Ahrs& last = samples_.back();
    const double ahead = seconds_between(last.utime, utime);
    if (ahead > kFarthest) return {};
    if (!last.has_rates) return last.q_WB;
    return last.q_WB * quaternion_from_rotation_vector(ahead * last.w_WB_B);
  }
  if (after->utime == utime) return after->q_WB;
  if (after == samples_.begin()) return {};
  const Ahrs& before = *std::prev(after);
  const double gap = seconds_between(before.utime, after->utime);
  if (gap > kLargestGap) return {};
  return before.q_WB.slerp(seconds_between(before.utime, utime) / gap, after->q_WB);
}

}  // namespace fathom::vision

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

std::optional<Eigen::Quaterniond> AttitudeHistory::turn(Utime from, Utime to) const {
  if (samples_.empty() || from >= to || from < samples_.front().utime) return {};
  if (seconds_between(samples_.back().utime, to) > kFarthest) return {};
  Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
  // Between two samples the rates are a line; behind the last one they hold.
  const auto add = [&](Utime begin, Utime end, const Eigen::Vector3d& w_begin, const Eigen::Vector3d& w_end) {
    turned = turned * quaternion_from_rotation_vector(0.5 * seconds_between(begin, end) * (w_begin + w_end));
  };
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Ahrs& a = samples_[i];
    const bool last = i + 1 == samples_.size();
    const Utime until = last ? to : samples_[i + 1].utime;
    if (until <= from || a.utime >= to) continue;
    if (!a.has_rates || (!last && !samples_[i + 1].has_rates)) return {};
    const Eigen::Vector3d w_next = last ? a.w_WB_B : samples_[i + 1].w_WB_B;
    const double gap = seconds_between(a.utime, until);
    if (gap > kLargestGap) return {};
    const auto w_at = [&](Utime t) -> Eigen::Vector3d {
      if (last || gap <= 0.0) return a.w_WB_B;
      return a.w_WB_B + seconds_between(a.utime, t) / gap * (w_next - a.w_WB_B);
    };
    const Utime begin = std::max(from, a.utime), end = std::min(to, until);
    if (end > begin) add(begin, end, w_at(begin), w_at(end));
  }
  return turned;
}

}  // namespace fathom::vision

#include "common/recordings/stamp_guard.hpp"

#include <algorithm>
#include <utility>

#include "common/base/time.hpp"

namespace fathom::recordings {

StampGuard::StampGuard(ClockRules rules, Believed believed, Refused refused)
    : rules_(rules), believed_(std::move(believed)), refused_(std::move(refused)) {}

void StampGuard::push(std::size_t topic, Stamp stamp, std::span<const double> values) {
  Judged& place = ring_[(first_ + held_) % ring_.size()];
  place.topic = topic;
  place.stamp = stamp;
  place.values.assign(values.begin(), values.end());
  if (++held_ == ring_.size()) judge();
}

void StampGuard::finish() {
  while (held_ > 0) judge();
}

StampGuard::Behind StampGuard::behind() const {
  std::array<std::int64_t, kBehind> stamps{};
  std::size_t count = 0;
  for (std::size_t i = 1; i < held_; ++i) {
    const std::int64_t stamp = ring_[(first_ + i) % ring_.size()].stamp.log;
    if (!is_time(stamp)) continue;
    std::size_t at = count++;  // into its place among those before
    for (; at > 0 && stamps[at - 1] > stamp; --at) stamps[at] = stamps[at - 1];
    stamps[at] = stamp;
  }
  if (count == 0) return {latest_, 0, 0};
  const std::int64_t median = stamps[(count - 1) / 2];
  return {median, median - stamps[count / 4], count};
}

bool StampGuard::believe(std::int64_t stamp) {
  if (!is_time(stamp)) return false;
  const std::int64_t ahead = std::max(rules_.ahead, kSteps * step_);
  const std::int64_t near = std::min(rules_.back, rules_.ahead);
  if (last_ != kNoTime && stamp >= last_ - near && stamp <= last_ + near) {  // the ordinary case: nothing to look up
    if (stamp > last_) step_ = std::max(stamp - last_, step_ / 2);
    last_ = std::max(last_, stamp);
    return true;
  }
  const Behind those = behind();
  if (last_ == kNoTime) {
    if (those.count >= kEnough &&
        (stamp < those.median - ahead - kSteps * those.spread || stamp > those.median + ahead))
      return false;
    last_ = stamp;
    return true;
  }
  const std::int64_t before = last_;
  if (stamp < std::min(before, those.median) - ahead || stamp > std::max(before, those.median) + ahead) return false;
  const bool starts_again = stamp < before - rules_.back;
  if (starts_again && those.median >= before - rules_.back) return false;  // those behind it go on as before
  if (starts_again || (stamp > before + rules_.leap && those.median > before + rules_.leap)) ++recording_;
  if (starts_again) {
    last_ = stamp;
    step_ = 0;
  } else if (stamp > before) {  // what is ahead of those behind it may be wrong by less than is told apart
    last_ = std::min(stamp, std::max(before, those.median));
    step_ = std::max(last_ - before, step_ / 2);
  }
  return true;
}

void StampGuard::judge() {
  const Judged& judged = ring_[first_];
  if (believe(judged.stamp.log)) {
    latest_ = judged.stamp.log;
    believed_(judged, recording_);
  } else {
    refused_(judged);
  }
  first_ = (first_ + 1) % ring_.size();
  --held_;
}

}  // namespace fathom::recordings

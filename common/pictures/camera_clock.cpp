#include "common/pictures/camera_clock.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::pictures {
namespace {

constexpr std::size_t kMost = 300;  // pictures that are remembered: ten seconds of a usual camera
constexpr std::size_t kFew = 60;    // that say whether a rate is kept
constexpr double kQuartz = 2e-3;    // share by which a camera's rate is another than stated
constexpr double kEarly = 0.1;      // of a period, by which a picture may be less delayed than any before
constexpr double kTogether = 0.45, kApart = 0.35;  // mean resultant of the phases: below, some come late by a period
constexpr double kFarEarly = 0.5;                  // the same, where it cannot be counted otherwise
constexpr std::size_t kMostMoved = 5;
constexpr double kPause = 2.0;  // s after which a camera may have begun anew

}  // namespace

void CameraClock::restart(Utime arrival) {
  arrivals_.clear();
  origin_ = arrival;
  arrivals_.push_back({});
  offset_ = 0.0;
  period_ = nominal_;
  delay_ = 0.0;
}

// One that came late by nearly a period was counted as the next: seen when that one comes.
bool CameraClock::make_room(std::int64_t number) {
  std::size_t moved = 0;
  for (std::int64_t below = number - 1; moved < arrivals_.size(); ++moved, --below) {
    if (arrivals_[arrivals_.size() - 1 - moved].number <= below) break;
  }
  if (moved > kMostMoved) return false;
  for (std::size_t i = 1; i <= moved; ++i)
    arrivals_[arrivals_.size() - i].number = number - static_cast<std::int64_t>(i);
  return true;
}

// Rayleigh's test: whether arrivals have a phase in common, however much they scatter and some are missing.
bool CameraClock::keeps_rate() const {
  if (arrivals_.size() < kFew) return steady_;
  double in_phase = 0.0, across = 0.0;
  for (const Arrival& each : arrivals_) {
    const double phase = 2.0 * M_PI * each.t / period_;
    in_phase += std::cos(phase);
    across += std::sin(phase);
  }
  return std::hypot(in_phase, across) > (steady_ ? kApart : kTogether) * static_cast<double>(arrivals_.size());
}

// The line that no arrival is below and that is nearest to all of them: it goes along the hull's edge over their
// middle.
void CameraClock::find_line() {
  hull_.clear();
  double middle = 0.0;
  for (const Arrival& each : arrivals_) {
    middle += static_cast<double>(each.number) / static_cast<double>(arrivals_.size());
    while (hull_.size() > 1) {
      const Arrival &a = hull_[hull_.size() - 2], &b = hull_.back();
      const double to_b = (b.t - a.t) * static_cast<double>(each.number - a.number);
      if (to_b < (each.t - a.t) * static_cast<double>(b.number - a.number)) break;
      hull_.pop_back();
    }
    hull_.push_back(each);
  }
  period_ = nominal_;
  for (std::size_t i = 1; i < hull_.size(); ++i) {
    if (static_cast<double>(hull_[i].number) < middle) continue;
    period_ = (hull_[i].t - hull_[i - 1].t) / static_cast<double>(hull_[i].number - hull_[i - 1].number);
    break;
  }
  period_ = std::clamp(period_, nominal_ * (1.0 - kQuartz), nominal_ * (1.0 + kQuartz));
  offset_ = INFINITY;
  for (const Arrival& each : hull_) offset_ = std::min(offset_, each.t - period_ * static_cast<double>(each.number));
}

std::optional<Utime> CameraClock::step(Utime arrival) {
  const Utime now = stamp(arrival);
  if (told_ && now <= *told_ && arrival >= *told_) return {};  // else arrivals themselves went back
  told_ = now;
  return now;
}

Utime CameraClock::stamp(Utime arrival) {
  if (arrivals_.empty()) {
    restart(arrival);
    return arrival;
  }
  const Arrival& last = arrivals_.back();
  const double t = seconds_between(origin_, arrival);
  if (!(t > last.t) || t - last.t > kPause) {
    restart(arrival);
    return arrival;
  }
  const double at = (t - offset_) / period_;
  auto number = static_cast<std::int64_t>(std::floor(at + kEarly));
  if (!make_room(number)) {
    number = last.number + 1;
    if (at < static_cast<double>(number) - kFarEarly) {
      if (arrivals_.size() < kFew) steady_ = false;  // and again
      restart(arrival);
      return arrival;
    }
  }
  arrivals_.push_back({number, t});
  if (arrivals_.size() > kMost) arrivals_.pop_front();
  find_line();
  steady_ = keeps_rate();
  delay_ = steady_ ? t - (offset_ + period_ * static_cast<double>(number)) : 0.0;
  return utime_after(arrival, -delay_);
}

}  // namespace fathom::pictures

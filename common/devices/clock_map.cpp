#include "common/devices/clock_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom::devices {
namespace {

constexpr double kBucket = 1.0;     // s
constexpr double kJump = 5.0;       // s between both clocks' steps: the instrument's was set or started anew
constexpr double kBackward = 0.5;   // s: messages out of order stay within this
constexpr double kSteepest = 1e-3;  // no quartz drifts by more
constexpr double kShortest = 30.0;  // s of points before drift is told from jitter

}  // namespace

void ClockMap::reset() {
  started_ = false;
  first_ = count_ = 0;
  slope_ = 0.0;
}

std::optional<double> ClockMap::drift() const {
  if (count_ < 2 || at(count_ - 1).device - at(0).device < kShortest) return {};
  return 1e6 * slope_;
}

void ClockMap::insert(const Point& point) {
  if (count_ > 0) {
    Point& newest = points_[(first_ + count_ - 1) % kWindow];
    if (std::floor(newest.device / kBucket) == std::floor(point.device / kBucket)) {
      if (point.offset < newest.offset) {
        newest = point;
        fit();
      }
      return;
    }
  }
  if (count_ == kWindow) {
    first_ = (first_ + 1) % kWindow;
    --count_;
  }
  points_[(first_ + count_++) % kWindow] = point;
  fit();
}

// The edge of the lower hull across the middle of the window: of all lines that no delay lies under, it has the
// smallest sum of distances (Moon, Skelly and Towsley 1999).
void ClockMap::fit() {
  const double middle = 0.5 * (at(0).device + at(count_ - 1).device);
  std::array<std::size_t, kWindow> hull{};
  std::size_t size = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const auto above = [&] {  // the last corner lies above the line from the one before it to the new point
      const Point& a = at(hull[size - 2]);
      const Point& b = at(hull[size - 1]);
      const Point& c = at(i);
      return (b.offset - a.offset) * (c.device - a.device) >= (c.offset - a.offset) * (b.device - a.device);
    };
    while (size >= 2 && above()) --size;
    hull[size++] = i;
  }
  slope_ = 0.0;
  const bool long_enough = at(count_ - 1).device - at(0).device >= kShortest;
  std::size_t edge = 1;
  while (edge + 1 < size && at(hull[edge]).device < middle) ++edge;
  if (long_enough && size >= 2) {
    const Point& a = at(hull[edge - 1]);
    const Point& b = at(hull[edge]);
    slope_ = std::clamp((b.offset - a.offset) / (b.device - a.device), -kSteepest, kSteepest);
    pivot_ = a.device;
    level_ = a.offset;
    return;
  }
  pivot_ = middle;
  level_ = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < size; ++i) level_ = std::min(level_, at(hull[i]).offset);
}

// Half a turn back is taken for the next turn; a restart that looks like one does not fit the host's clock.
double ClockMap::unrolled(double device_time) {
  if (turn_ > 0.0 && started_ && device_time + turned_ < last_device_ - 0.5 * turn_) turned_ += turn_;
  return device_time + turned_;
}

Utime ClockMap::map(std::optional<double> device_time, Utime arrival) {
  Utime utime = arrival;
  if (device_time) {
    device_time = unrolled(*device_time);
    if (!started_) {
      started_ = true;
      origin_ = arrival;
    } else {
      const double expected = seconds_between(origin_, arrival) - (level_ + slope_ * (*device_time - pivot_));
      const bool jumped = std::abs(expected - *device_time) > kJump || *device_time < last_device_ - kBackward;
      if (jumped) {
        ++restarts_;
        reset();
        started_ = true;
        origin_ = arrival;
      }
    }
    last_device_ = *device_time;
    insert({.device = *device_time, .offset = seconds_between(origin_, arrival) - *device_time});
    utime = utime_after(origin_, *device_time + level_ + slope_ * (*device_time - pivot_) + 0.5 * tick_);
    utime = std::min(utime, utime_after(arrival, 0.5 * tick_));
  }
  utime = utime_after(utime, -latency_);
  if (last_ && utime <= *last_ && *last_ - utime < 1'000'000) utime = *last_ + 1;
  last_ = utime;
  return utime;
}

}  // namespace fathom::devices

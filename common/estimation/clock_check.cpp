#include "common/estimation/clock_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fathom::estimation {
namespace {

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, value < 10.0 ? "%.2g s" : "%.0f s", value);
  return text;
}

void keep(std::optional<Utime>& since, bool holds, Utime now) {
  if (!holds) {
    since.reset();
  } else if (!since) {
    since = now;
  }
}

}  // namespace

void ClockCheck::hear(std::size_t channel, Utime utime, double age, double late, double gap) {
  if (channel >= kMost) return;
  Channel& one = channels_[channel];
  const Utime now = utime_after(utime, age);  // the newest attitude's: everybody's arrival by one clock
  if (one.last && std::abs(seconds_between(*one.last, now)) > kForgotten) one = {};
  one.last = newest_ = now;
  one.age = age;
  one.stated = late;
  one.gap = gap;
  keep(one.late_since, one.late() > kAllLate, now);
  keep(one.ahead_since, age < -gap, now);
}

bool ClockCheck::lasts(const std::optional<Utime>& since, const Channel& channel) const {
  return since && seconds_between(*since, *channel.last) >= kLasts;
}

std::string ClockCheck::complaint(std::span<const char* const> names) const {
  const std::size_t count = std::min(names.size(), kMost);
  const auto heard = [&](const Channel& one) {
    return one.last && std::abs(seconds_between(*one.last, newest_)) <= kForgotten;
  };
  std::size_t late = 0, ahead = 0, latest = kMost, foremost = kMost;
  double least_late = HUGE_VAL, least_ahead = HUGE_VAL;
  for (std::size_t i = 0; i < count; ++i) {
    const Channel& one = channels_[i];
    if (!heard(one)) continue;
    if (lasts(one.late_since, one)) {
      ++late;
      least_late = std::min(least_late, one.late());
      if (latest == kMost || one.late() > channels_[latest].late()) latest = i;
    }
    if (lasts(one.ahead_since, one)) {
      ++ahead;
      least_ahead = std::min(least_ahead, -one.age);
      if (foremost == kMost || one.age < channels_[foremost].age) foremost = i;
    }
  }
  // Whether an attitude sensor whose clock is off by so much would leave every channel as it is: one that is slow by
  // itself is not ahead of it, and speaks for nobody.
  const auto explains = [&](double behind) {
    for (std::size_t i = 0; i < count; ++i) {
      const Channel& one = channels_[i];
      const double age = one.age + behind;  // by a right clock
      if (heard(one) && (age > one.stated + kAllLate || age < -one.gap)) return false;
    }
    return true;
  };
  if (ahead > 1 && explains(least_ahead))
    return "AHRS is " + seconds(least_ahead) + " behind the other sensors; is its clock right, and its link quick?";
  if (late > 1 && explains(-least_late))
    return "all other sensors come " + seconds(least_late) + " later than stated; is the clock of AHRS ahead?";
  if (foremost != kMost)
    return std::string{names[foremost]} + " is " + seconds(-channels_[foremost].age) +
           " ahead of AHRS; is its clock right?";
  if (latest != kMost && channels_[latest].late() > kOneLate)
    return std::string{names[latest]} + " comes " + seconds(channels_[latest].late()) +
           " later than stated; is its clock right, and its link quick?";
  return {};
}

}  // namespace fathom::estimation

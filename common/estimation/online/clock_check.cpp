#include "common/estimation/online/clock_check.hpp"

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

bool ClockCheck::heard(const Channel& one) const {
  return one.last && std::abs(seconds_between(*one.last, newest_)) <= kForgotten;
}

// Whether an attitude sensor whose clock is off by so much would leave every channel as it is: one that is slow by
// itself is not ahead of it, and speaks for nobody.
bool ClockCheck::explained_by(double behind) const {
  return std::ranges::none_of(channels_, [&](const Channel& one) {
    const double age = one.age + behind;  // by a right clock
    return heard(one) && (age > one.stated + kAllLate || age < -one.gap);
  });
}

std::string ClockCheck::attitude() const {
  std::size_t late = 0, ahead = 0;
  double least_late = HUGE_VAL, least_ahead = HUGE_VAL;
  for (const Channel& one : channels_) {
    if (!heard(one)) continue;
    if (lasts(one.late_since, one)) {
      ++late;
      least_late = std::min(least_late, one.late());
    }
    if (lasts(one.ahead_since, one)) {
      ++ahead;
      least_ahead = std::min(least_ahead, -one.age);
    }
  }
  if (ahead > 1 && explained_by(least_ahead))
    return "AHRS is " + seconds(least_ahead) + " behind the other sensors; is its clock right, and its link quick?";
  if (late > 1 && explained_by(-least_late))
    return "all other sensors come " + seconds(least_late) + " later than stated; is the clock of AHRS ahead?";
  return {};
}

std::string ClockCheck::off(std::size_t channel, const char* name) const {
  const Channel& one = channels_[channel];
  if (!heard(one)) return {};
  if (one.ahead_since) return std::string{name} + " is " + seconds(-one.age) + " ahead of AHRS; is its clock right?";
  if (!one.late_since) return {};
  return std::string{name} + " comes " + seconds(one.late()) +
         " later than stated; is its clock right, and its link quick?";
}

std::string ClockCheck::odd_one(std::span<const char* const> names, std::span<const double> tolerated) const {
  std::string line;
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    const Channel& one = channels_[i];
    const double tolerance = std::max(kOneOff, i < tolerated.size() ? tolerated[i] : 0.0);
    const double by = one.ahead_since ? -one.age : one.late();
    if (!heard(one) || !(lasts(one.late_since, one) || lasts(one.ahead_since, one))) continue;
    if (by < std::max(tolerance, most)) continue;
    most = by;
    line = off(i, names[i]);
  }
  return line;
}

}  // namespace fathom::estimation

#include "common/base/remaining_time.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fathom {
namespace {

constexpr double kMemory = 20.0;  // units: what a unit costs changes as the work goes on
constexpr double kGuess = 1.0;    // units: weight of the guess beside those that were timed
constexpr double kEnough = 0.02;  // of the weight of all work: from less nothing can be foretold
// Of its age, what a unit that is older than expected is still thought to take: as for lifetimes with a heavy tail.
constexpr double kOverdue = 0.25;

}  // namespace

RemainingTime::Phase& RemainingTime::phase(std::string_view name) {
  const auto known = std::ranges::find(phases_, name, &Phase::name);
  if (known != phases_.end()) return *known;
  return phases_.emplace_back(Phase{.name = std::string{name}});
}

void RemainingTime::spend(double now) {
  if (begun_) phases_[current_].running += std::max(now - since_, 0.0);
  since_ = now;
}

void RemainingTime::take(double now, const Progress::Event& event) {
  spend(now);
  Phase& its = phase(event.phase);
  switch (event.kind) {
    case Progress::Event::Kind::kExpect:
      its.to_come = std::max(event.units, 0.0);
      its.weight = event.weight;
      break;
    case Progress::Event::Kind::kBegin:
      current_ = static_cast<std::size_t>(&its - phases_.data());
      begun_ = true;
      its.to_come = std::max(its.to_come, 1.0);  // what nobody announced takes its time all the same
      break;
    case Progress::Event::Kind::kDone: {
      if (event.units <= 0.0) break;
      const double kept = std::exp(-event.units / kMemory);
      its.recent_units = kept * its.recent_units + event.units;
      its.recent_time = kept * its.recent_time + its.running;
      its.units += event.units;
      its.time += its.running;
      its.running = 0.0;
      its.to_come = std::max(its.to_come - event.units, 0.0);
      break;
    }
  }
}

std::optional<double> RemainingTime::left(double now) const {
  double time = 0.0, weight = 0.0, to_come = 0.0;
  for (const Phase& one : phases_) {
    time += one.time;
    weight += one.weight * one.units;
    to_come += one.weight * one.to_come;
  }
  if (weight <= 0.0 || weight < kEnough * (weight + to_come)) return {};
  const double pace = time / weight;  // s per unit of weight
  double left = 0.0;
  for (std::size_t i = 0; i < phases_.size(); ++i) {
    const Phase& one = phases_[i];
    if (one.to_come <= 0.0) continue;
    const double guess = pace * one.weight;
    const double cost = one.units > 0.0 ? (kGuess * guess + one.recent_time) / (kGuess + one.recent_units) : guess;
    const bool current = begun_ && i == current_;
    const double age = one.running + (current ? std::max(now - since_, 0.0) : 0.0);
    const double unit = std::min(one.to_come, 1.0);  // that is going on
    left += cost * (one.to_come - unit) + std::max(cost * unit - age, kOverdue * age);
  }
  return left;
}

std::string time_left(double seconds) {
  char text[48];
  const auto rounded = [&](double step) { return step * std::round(seconds / step); };
  if (seconds < 8.0) return "some seconds left";
  if (seconds < 85.0) {
    std::snprintf(text, sizeof text, "about %.0f s left", rounded(10.0));
  } else if (seconds < 585.0) {
    std::snprintf(text, sizeof text, "about %.3g min left", rounded(30.0) / 60.0);
  } else if (seconds < 7000.0) {
    std::snprintf(text, sizeof text, "about %.0f min left", rounded(300.0) / 60.0);
  } else {
    std::snprintf(text, sizeof text, "about %.3g h left", rounded(1800.0) / 3600.0);
  }
  return text;
}

}  // namespace fathom

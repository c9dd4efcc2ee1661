#include "common/board/roll.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

namespace fathom::board {
namespace {

bool ended(const Health& health) { return health.state == "stopped" || health.state == "fault"; }

bool same_place(const Health& a, const Health& b) { return a.process == b.process && a.host == b.host; }

}  // namespace

bool Roll::gone(const Seen& seen, double now) { return ended(seen.health) || now - seen.last > kSilence; }

void Roll::hear(const Health& health, double now) {
  auto known = std::find_if(seen_.begin(), seen_.end(), [&](const Seen& each) {
    return same_place(each.health, health) && each.health.pid == health.pid;
  });
  if (known != seen_.end()) {
    known->health = health;
    known->last = now;
  } else {
    const auto quietest = [](const Seen& a, const Seen& b) { return a.last < b.last; };
    if (seen_.size() >= kMost) seen_.erase(std::min_element(seen_.begin(), seen_.end(), quietest));
    seen_.push_back({.health = health, .first = now, .last = now, .returns = 0});
    known = std::prev(seen_.end());
  }
  Seen heir = std::move(*known);
  seen_.erase(known);
  succeed(heir, now);
  seen_.push_back(std::move(heir));
}

// Whoever has ended is forgotten once there is another one of its name in its place.
void Roll::succeed(Seen& heir, double now) {
  std::erase_if(seen_, [&](const Seen& other) {
    if (!same_place(other.health, heir.health) || !gone(other, now)) return false;
    heir.returns += other.returns + (other.last < heir.first ? 1 : 0);
    return true;
  });
}

// One that was killed and started again is no second one, though both have spoken within three seconds: twins speak in
// turn, so each has said something since the other began.
std::vector<Roll::Entry> Roll::entries(double now) const {
  std::vector<Entry> all;
  for (const Seen& one : seen_) {
    Entry entry{.health = one.health, .age = std::max(now - one.last, 0.0), .state = one.health.state};
    entry.returns = one.returns;
    bool replaced = false;
    for (const Seen& other : seen_) {
      if (&other == &one || other.health.process != one.health.process) continue;
      const bool both = !gone(one, now) && !gone(other, now);
      entry.second = entry.second || (both && one.last >= other.first && other.last >= one.first);
      replaced = replaced || (other.health.host == one.health.host && other.first > one.last);
    }
    if (replaced && !entry.second) continue;
    entry.detail = one.health.detail;
    if (!ended(one.health) && gone(one, now)) {
      entry.state = "silent";
      entry.detail = "no HEALTH for " + std::to_string(std::lround(entry.age)) + " s";
    }
    if (entry.second) entry.detail = "a second process of this name speaks on this bus; " + entry.detail;
    entry.healthy = entry.state == "running" && !entry.second;
    all.push_back(std::move(entry));
  }
  std::sort(all.begin(), all.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.health.process, a.health.host, a.health.pid) <
           std::tie(b.health.process, b.health.host, b.health.pid);
  });
  return all;
}

}  // namespace fathom::board

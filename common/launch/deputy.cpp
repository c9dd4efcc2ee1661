#include "common/launch/deputy.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include "common/launch/ending.hpp"

namespace fathom::launch {
namespace {

constexpr double kKillAgain = 1.0;  // s between two SIGKILL to one that does not die
constexpr double kNever = 1e18;
constexpr std::int32_t kRefused = 126 << 8;  // wait status of exit(126), a shell's "found, and not to be run"

}  // namespace

void Deputy::say(const Entry& entry, std::string text) {
  acts_.push_back({.kind = Act::Kind::kSay, .id = entry.status.command.id, .text = std::move(text) + "\n"});
}

void Deputy::hear(const LaunchOrders& orders, Utime wall, double now) {
  if (closing_ || orders.deputy != name_) return;
  if (const double age = seconds_between(orders.utime, wall); std::abs(age) > kStale) {
    const std::string how = age > 0.0 ? " s old" : " s ahead of this clock";
    for (const CommandOrder& each : orders.commands) {
      acts_.push_back({.kind = Act::Kind::kSay,
                       .id = each.command.id,
                       .text = "ignoring stale orders, " + std::to_string(std::llround(std::abs(age))) + how +
                               ": do the clocks of the hosts agree?\n"});
    }
    return;
  }
  for (auto& [id, entry] : entries_) entry.forget = true;
  for (const CommandOrder& each : orders.commands) {
    if (each.command.id.empty()) continue;
    const auto [found, is_new] = entries_.try_emplace(each.command.id);
    if (is_new) {
      order_.push_back(each.command.id);
      changed_ = true;
    }
    found->second.forget = false;
    obey(found->second, each, now);
  }
  for (auto& [id, entry] : entries_) {
    if (!entry.forget) continue;
    entry.respawn.reset();
    if (entry.runs() && !entry.signalled) stop(entry, now);
  }
  tick(now);
}

void Deputy::obey(Entry& entry, const CommandOrder& order, double now) {
  CommandStatus& status = entry.status;
  // What runs, or will be started again, keeps its own command line beside one that may not be run.
  if (permits(order.command) || !(entry.runs() || entry.respawn)) {
    if (!(status.command == order.command)) changed_ = true;
    status.command = order.command;
  }
  entry.wanted = !order.stop;
  const bool anew = order.run != status.run;
  if (!entry.runs() && entry.wanted && anew) {
    status.run = order.run;
    entry.backoff = {};
    start(entry, now);
  } else if (entry.runs() && (!entry.wanted || (anew && order.run != 0))) {
    entry.respawn.reset();
    if (!entry.signalled) stop(entry, now);
  } else if (order.run != 0) {
    status.run = order.run;
  }
  if (!entry.wanted) entry.respawn.reset();
}

void Deputy::start(Entry& entry, double now) {
  entry.respawn.reset();
  if (!permits(entry.status.command)) {
    entry.wanted = false;
    entry.status.wait_status = kRefused;
    changed_ = true;
    return say(entry, "refused: this command line is not in " + allowed_->files() + " (--allow) on this host");
  }
  entry.signalled.reset();
  entry.killed.reset();
  entry.health.reset();
  entry.hangs = false;
  entry.computed = now;
  entry.starting = true;
  entry.status.wait_status = 0;
  entry.backoff.started(now);
  acts_.push_back({.kind = Act::Kind::kStart, .id = entry.status.command.id, .exec = entry.status.command.exec});
  changed_ = true;
}

void Deputy::stop(Entry& entry, double now) {
  entry.signalled = now;
  acts_.push_back(
      {.kind = Act::Kind::kSignal, .id = entry.status.command.id, .signal = entry.status.command.stop_signal});
  // A stopped process (SIGSTOP) would take the signal only once it goes on.
  acts_.push_back({.kind = Act::Kind::kSignal, .id = entry.status.command.id, .signal = SIGCONT});
  changed_ = true;
}

void Deputy::kill(Entry& entry, double now) {
  entry.killed = now;
  acts_.push_back({.kind = Act::Kind::kSignal, .id = entry.status.command.id, .signal = SIGKILL});
}

void Deputy::started(const std::string& id, std::int32_t pid, double now) {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return;
  found->second.starting = false;
  found->second.status.pid = pid;
  found->second.computed = now;
  changed_ = true;
}

void Deputy::died(const std::string& id, std::int32_t wait_status, double now) {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return;
  Entry& entry = found->second;
  entry.starting = false;
  entry.status.pid = 0;
  entry.status.cpu = 0.0F;
  entry.status.virtual_memory = entry.status.resident_memory = 0;
  entry.status.wait_status = wait_status;
  changed_ = true;
  const std::string how = describe_end(wait_status);
  const bool asked = entry.signalled.has_value();
  if (!how.empty() && !(asked && stopped_by_signal(wait_status))) say(entry, how);
  entry.signalled.reset();
  entry.killed.reset();
  entry.health.reset();
  if (!asked && entry.wanted && !entry.forget && !closing_ && entry.status.command.auto_respawn) {
    entry.respawn = now + entry.backoff.delay();
  }
  tick(now);
}

void Deputy::healthy(std::int32_t pid, double now) {
  for (auto& [id, entry] : entries_) {
    if (entry.status.pid == pid) entry.health = now;
  }
}

void Deputy::uses(const std::string& id, const Use& use, double now) {
  const auto found = entries_.find(id);
  if (found == entries_.end() || found->second.status.pid <= 0) return;
  CommandStatus& status = found->second.status;
  status.cpu = use.cpu;
  status.virtual_memory = use.virtual_memory;
  status.resident_memory = use.resident_memory;
  if (use.computes) found->second.computed = now;
}

// Only a program that has spoken once can fall silent: others never say HEALTH.
void Deputy::watch(Entry& entry, double now) {
  if (!entry.health || entry.signalled || entry.hangs) return;
  const double silent = now - *entry.health;
  if (silent < kSilence || (now - entry.computed < kSilence && silent < kBusy)) return;
  entry.hangs = true;
  const std::string what = "says no HEALTH for " + std::to_string(static_cast<int>(silent)) + " s" +
                           (silent < kBusy ? " and does nothing" : "");
  if (!entry.status.command.auto_respawn) return say(entry, what + "; not restarted, since auto_respawn is off");
  say(entry, what + "; killed, to be started again");
  kill(entry, now);
}

void Deputy::tick(double now) {
  for (auto& [id, entry] : entries_) {
    if (entry.status.pid > 0) watch(entry, now);
    const double allowed = std::max(0.0F, entry.status.command.stop_time_allowed);
    const bool due = entry.signalled && now - *entry.signalled >= allowed;
    if (entry.status.pid > 0 && due && (!entry.killed || now - *entry.killed >= kKillAgain)) {
      if (!entry.killed) say(entry, "does not stop; killed");
      kill(entry, now);
    }
    if (!entry.runs() && entry.respawn && now >= *entry.respawn) start(entry, now);
  }
  std::erase_if(entries_, [&](const auto& each) {
    const bool gone = each.second.forget && !each.second.runs();
    if (gone) {
      std::erase(order_, each.first);
      changed_ = true;
    }
    return gone;
  });
}

void Deputy::shut_down(double now) {
  closing_ = true;
  for (auto& [id, entry] : entries_) {
    entry.wanted = false;
    entry.respawn.reset();
    if (entry.runs() && !entry.signalled) stop(entry, now);
  }
}

std::vector<Act> Deputy::take_acts() { return std::exchange(acts_, {}); }
bool Deputy::take_changed() { return std::exchange(changed_, false); }

bool Deputy::over() const {
  return closing_ &&
         std::none_of(entries_.begin(), entries_.end(), [](const auto& each) { return each.second.runs(); });
}

DeputyInfo Deputy::info(Utime wall) const {
  DeputyInfo info{.utime = wall, .deputy = name_, .commands = {}};
  for (const std::string& id : order_) info.commands.push_back(entries_.at(id).status);
  return info;
}

double Deputy::idle(double now) const {
  double next = now + 1.0;
  for (const auto& [id, entry] : entries_) {
    const double stop = entry.signalled ? *entry.signalled + entry.status.command.stop_time_allowed : kNever;
    next = std::min({next, entry.respawn.value_or(kNever), entry.killed ? *entry.killed + kKillAgain : stop});
  }
  return std::max(0.001, next - now);
}

}  // namespace fathom::launch

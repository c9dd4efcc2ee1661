#include "common/launch/sheriff.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <utility>

#include "common/launch/ending.hpp"

namespace fathom::launch {

const char* word(State state) {
  switch (state) {
    case State::kUnheard:
      return "no deputy";
    case State::kLost:
      return "deputy lost";
    case State::kStarting:
      return "starting";
    case State::kRestarting:
      return "restarting";
    case State::kRunning:
      return "running";
    case State::kStopping:
      return "stopping";
    case State::kIdle:
      return "-";
    case State::kStopped:
      return "stopped";
    case State::kFailed:
      return "FAILED";
    case State::kUnknown:
      return "unknown";
  }
  return "unknown";
}

Sheriff::Sheriff(std::string id, LaunchConfig config) : id_{std::move(id)}, config_{std::move(config)} {
  for (const ConfiguredCommand& each : config_.commands) {
    entries_.push_back({.command = each.command, .deputy = each.deputy, .running_exec = {}});
  }
}

void Sheriff::hear(const DeputyInfo& info, Utime wall, double now) {
  if (seconds_between(info.utime, wall) > kStale) return;
  heard_[info.deputy] = now;
  for (Entry& entry : entries_) {
    if (entry.deputy == info.deputy) entry.status.reset();
  }
  for (const CommandStatus& status : info.commands) {
    const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& each) {
      return each.deputy == info.deputy && each.command.id == status.command.id;
    });
    if (found != entries_.end()) {
      adopt(*found, status, now);
    } else {
      entries_.push_back({.command = status.command, .deputy = info.deputy, .foreign = true, .running_exec = {}});
      adopt(entries_.back(), status, now);
    }
  }
  // A foreign command that its deputy no longer has is gone.
  std::erase_if(entries_, [&](const Entry& each) {
    return each.foreign && each.deputy == info.deputy && !each.status.has_value();
  });
}

// Respawned quickly, a program that cannot live looks as if it ran: its deaths are counted.
void Sheriff::count_failures(Entry& entry, const CommandStatus& status, double now) {
  std::erase_if(entry.failures, [&](double at) { return now - at > kRecent; });
  const bool died = entry.last_pid > 0 && status.pid != entry.last_pid && !entry.stop && status.run == entry.desired;
  if (status.pid == 0 && status.wait_status != 0) entry.last_end = status.wait_status;
  if (died && (status.pid > 0 || status.wait_status != 0)) entry.failures.push_back(now);
  entry.last_pid = status.pid;
}

void Sheriff::adopt(Entry& entry, const CommandStatus& status, double now) {
  const bool ran = entry.last_pid > 0;
  count_failures(entry, status, now);
  const bool first = !std::exchange(entry.adopted, true);
  entry.status = status;
  if (first && status.pid > 0) entry.running_exec = status.command.exec;
  if (status.run != 0 && !entry.stop && (entry.desired == 0 || (first && status.pid > 0))) entry.desired = status.run;
  // What stands still when it is adopted was stopped by somebody, or will be seen running soon.
  if (status.pid > 0 && status.run == entry.desired && !entry.stop) entry.started = true;
  // A finished program is not started anew should its deputy restart.
  if (status.pid == 0 && status.run == entry.desired && status.run != 0 && !status.command.auto_respawn) {
    entry.by_itself = entry.by_itself || (!entry.stop && ran);
    entry.stop = true;
  }
  if (status.pid > 0 && status.run == entry.desired && !first && entry.running_exec.empty()) {
    entry.running_exec = entry.command.exec;
  }
  if (status.pid == 0) entry.running_exec.clear();
}

void Sheriff::hear(const LaunchOrders& orders, double now) {
  if (orders.sheriff == id_) return;
  rival_ = orders.sheriff;
  rival_heard_ = now;
}

void Sheriff::start(const Target& target) {
  for (Entry& entry : entries_) {
    if (!covers(target, entry.command)) continue;
    if (entry.status && entry.status->pid > 0 && !entry.stop) continue;
    ++entry.desired;
    entry.stop = entry.by_itself = false;
    entry.started = true;
  }
  ordered_ = changed_ = true;
}

void Sheriff::restart(const Target& target) {
  for (Entry& entry : entries_) {
    if (!covers(target, entry.command)) continue;
    ++entry.desired;
    entry.stop = entry.by_itself = false;
    entry.started = true;
    entry.running_exec.clear();
  }
  ordered_ = changed_ = true;
}

void Sheriff::stop(const Target& target) {
  for (Entry& entry : entries_) {
    if (covers(target, entry.command)) entry.stop = true;
  }
  ordered_ = changed_ = true;
}

std::vector<LaunchOrders> Sheriff::orders(Utime wall) const {
  std::vector<LaunchOrders> all;
  if (!ordered_) return all;
  for (const auto& [deputy, heard] : heard_) {
    LaunchOrders one{.utime = wall, .deputy = deputy, .sheriff = id_, .commands = {}};
    for (const Entry& entry : entries_) {
      if (entry.deputy == deputy) one.commands.push_back({entry.command, entry.desired, entry.stop});
    }
    all.push_back(std::move(one));
  }
  return all;
}

bool Sheriff::take_changed() { return std::exchange(changed_, false); }

State Sheriff::state(const Entry& entry, double now) const {
  const auto heard = heard_.find(entry.deputy);
  if (heard == heard_.end()) return State::kUnheard;
  if (now - heard->second > kLost) return State::kLost;
  if (!entry.status) return entry.desired != 0 && !entry.stop ? State::kStarting : State::kIdle;
  const CommandStatus& status = *entry.status;
  if (status.run != entry.desired) {
    if (entry.stop) return status.pid > 0 ? State::kStopping : State::kUnknown;
    return status.pid > 0 ? State::kRestarting : State::kStarting;
  }
  if (status.pid > 0) return entry.stop ? State::kStopping : State::kRunning;
  if (status.run == 0) return State::kIdle;
  const bool shot = entry.by_itself && WIFSIGNALED(status.wait_status) && WTERMSIG(status.wait_status) == SIGKILL;
  const bool well = status.wait_status == 0 || (entry.stop && !shot && stopped_by_signal(status.wait_status));
  return well ? State::kStopped : State::kFailed;
}

std::vector<Sheriff::Row> Sheriff::rows(double now) const { return rows(Target{}, now); }

std::vector<Sheriff::Row> Sheriff::rows(const Target& target, double now) const {
  std::vector<Row> found;
  for (const Entry& entry : entries_) {
    if (!covers(target, entry.command)) continue;
    Row row{.command = entry.command,
            .deputy = entry.deputy,
            .state = state(entry, now),
            .status = entry.status.value_or(CommandStatus{}),
            .started = entry.started,
            .wanted = entry.started && !entry.stop,
            .differs = !entry.running_exec.empty() && entry.running_exec != entry.command.exec,
            .foreign = entry.foreign,
            .failures = static_cast<int>(std::count_if(entry.failures.begin(), entry.failures.end(),
                                                       [&](double at) { return now - at < kRecent; })),
            .last_end = entry.last_end};
    found.push_back(std::move(row));
  }
  return found;
}

std::vector<std::string> Sheriff::unheard_deputies(double now) const {
  std::vector<std::string> names;
  for (const std::string& each : config_.deputies()) {
    const auto heard = heard_.find(each);
    if (heard == heard_.end() || now - heard->second > kLost) names.push_back(each);
  }
  return names;
}

std::string Sheriff::rival(double now) const { return !rival_.empty() && now - rival_heard_ < kLost ? rival_ : ""; }

std::vector<std::string> Sheriff::complaints(double now, bool onlooker) const {
  std::vector<std::string> found;
  for (const Row& row : rows(now)) {
    const std::string end = describe_end(row.status.wait_status);
    if (row.failures >= 2 && row.wanted) {
      found.push_back(row.command.id + " on " + row.deputy + " keeps failing, " + std::to_string(row.failures) +
                      " times in 10 s: " + describe_end(row.last_end));
    } else if (row.state == State::kFailed && (row.started || onlooker)) {
      found.push_back(row.command.id + " on " + row.deputy + " failed: " + end);
    } else if (row.wanted && row.state != State::kRunning) {
      found.push_back(row.command.id + " on " + row.deputy + " shall run: " + word(row.state) +
                      (end.empty() ? "" : ", last end: " + end));
    } else if (row.state == State::kStopping) {
      found.push_back(row.command.id + " on " + row.deputy + " does not stop");
    }
    if (row.differs && row.wanted) {
      found.push_back(row.command.id + " on " + row.deputy + " runs with another command line than " + config_.path +
                      " says; restart it");
    }
  }
  return found;
}

}  // namespace fathom::launch

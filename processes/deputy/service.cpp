#include "processes/deputy/service.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <utility>

#include "common/runtime/self.hpp"
#include "processes/deputy/environment.hpp"

namespace fathom::deputy {
namespace {

Utime wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}
double steady() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

constexpr std::size_t kOwnInfos = 50;      // that are remembered: 10 ms between two at the least
constexpr double kRivalAgain = 10.0;       // s between two lines about a second deputy
constexpr std::int32_t kNotFound = 65280;  // wait status of exit(255)

void log(const std::string& text) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char clock[16];
  std::strftime(clock, sizeof clock, "%H:%M:%S", &local);
  std::fprintf(stderr, "%s deputy: %s\n", clock, text.c_str());
}

std::optional<launch::AllowList> allow_list(const Options& options) {
  if (options.allow.empty()) return {};
  return launch::AllowList::load(options.allow, options.name);
}

std::string describe(const std::optional<launch::AllowList>& list) {
  if (!list) return std::string{launch::kAllowed} + "any that is ordered (no --allow)";
  return launch::kAllowed + std::string{"only the "} + std::to_string(list->size()) + " of " + list->files();
}

}  // namespace

Service::Service(Options options)
    : options_{std::move(options)},
      mind_{options_.name, allow_list(options_)},
      children_{[this](const std::string& id, std::string_view text) { print(id, text); },
                [this](const std::string& id, std::int32_t status) { mind_.died(id, status, steady()); }},
      bus_{options_.url,
           variable("LCM_DEFAULT_URL"),
           {.orders =
                [this](const LaunchOrders& orders) {
                  if (!looking_) mind_.hear(orders, wall_clock(), steady());
                },
            .info = [this](const DeputyInfo& info) { hear(info); },
            .discovery = [this](const LaunchDiscovery& discovery) { hear(discovery); },
            .health =
                [this, host = runtime::host_name()](const Health& health) {
                  if (health.host == host) mind_.healthy(health.pid, steady());
                }}} {}

void Service::hear(const DeputyInfo& info) {
  if (info.deputy != options_.name) return;
  if (looking_) {
    log("another deputy named " + options_.name + " is on " + options_.url +
        "; stop it, or give this one another --id");
    status_ = 2;
    return;
  }
  const double now = steady();
  if (std::find(told_.begin(), told_.end(), info.utime) != told_.end() || now - rival_told_ < kRivalAgain) return;
  rival_told_ = now;
  print("", "another deputy is named " + options_.name + " too: both start every program; stop one of them\n");
}

void Service::hear(const LaunchDiscovery& discovery) {
  if (!looking_) {
    tell_now_ = asked_ = true;
    return;
  }
  // Of two that start together the one with the lower number stays.
  if (discovery.transmitter != options_.name || discovery.nonce == getpid() || discovery.nonce > getpid()) return;
  log("another deputy named " + options_.name + " is just starting");
  status_ = 1;
}

void Service::print(const std::string& id, std::string_view text) {
  output_.add(id, text, steady());
  if (id.empty()) log(std::string{text.substr(0, text.find('\n'))});
  if (options_.verbose && !id.empty())
    std::fprintf(stderr, "%s: %.*s", id.c_str(), static_cast<int>(text.size()), text.data());
}

// Starting may fail at once, which may be followed by further acts.
void Service::act() {
  for (auto acts = mind_.take_acts(); !acts.empty(); acts = mind_.take_acts()) {
    for (const launch::Act& act : acts) {
      if (act.kind == launch::Act::Kind::kStart) {
        const std::int32_t pid = children_.start(act.id, act.exec);
        if (pid > 0) {
          used_.erase(act.id);
          mind_.started(act.id, pid, steady());
        } else {
          mind_.died(act.id, kNotFound, steady());
        }
        log(act.id + (pid > 0 ? " started, process " + std::to_string(pid) : " cannot be run: " + act.exec));
      } else if (act.kind == launch::Act::Kind::kSignal) {
        children_.signal(act.id, act.signal);
      } else {
        output_.add(act.id, act.text, steady());
        log(act.id + ": " + act.text.substr(0, act.text.find('\n')));
      }
    }
  }
}

void Service::measure(double now) {
  const Jiffies before = std::exchange(jiffies_, jiffies());
  const auto all = static_cast<float>(std::max<std::int64_t>(1, jiffies_.all - before.all));
  load_ = static_cast<float>(jiffies_.busy - before.busy) / all;
  for (const CommandStatus& each : mind_.info(0).commands) {
    if (each.pid <= 0) continue;
    const auto figures = figures_of(each.pid);
    if (!figures) continue;
    const auto [used, is_new] = used_.try_emplace(each.command.id, figures->jiffies);
    const std::int64_t fresh = figures->jiffies - std::exchange(used->second, figures->jiffies);
    mind_.uses(each.command.id,
               {.cpu = is_new ? 0.0F : static_cast<float>(fresh) / all,
                .virtual_memory = figures->virtual_memory,
                .resident_memory = figures->resident_memory,
                .computes = fresh > 0},
               now);
  }
}

void Service::tell() {
  DeputyInfo info = mind_.info(wall_clock());
  info.cpu_load = load_;
  read_memory(info);
  told_.push_back(info.utime);
  if (told_.size() > kOwnInfos) told_.erase(told_.begin());
  bus_.say(info);
}

// In procman's words, since its protocol has no place for it: a text of the deputy itself.
void Service::tell_allowed() {
  bus_.say(LaunchOutput{
      .utime = wall_clock(), .deputy = options_.name, .texts = {{.id = "", .text = describe(mind_.allowed()) + "\n"}}});
}

void Service::flush(double now) {
  auto texts = output_.take(now);
  if (!texts.empty()) bus_.say(LaunchOutput{.utime = wall_clock(), .deputy = options_.name, .texts = std::move(texts)});
}

void Service::wait(double seconds) {
  seconds = std::min(seconds, systemd_.alive(steady()));
  std::vector<pollfd> watched{{.fd = signals_.descriptor(), .events = POLLIN, .revents = 0}};
  for (const int each : bus_.descriptors()) watched.push_back({.fd = each, .events = POLLIN, .revents = 0});
  children_.watch(watched);
  const double limit = bus_.pending()      ? 0.0
                       : output_.waiting() ? std::min(seconds, launch::OutputLimit::kWait)
                                           : seconds;
  poll(watched.data(), watched.size(), static_cast<int>(std::ceil(1e3 * std::max(0.0, limit))));
  signals_.read();
  children_.read();
  children_.reap();
  bus_.serve();
}

int Service::run() {
  const double begin = steady();
  for (double call = begin; steady() < begin + kLook;) {
    if (steady() >= call) {
      bus_.say(LaunchDiscovery{.utime = wall_clock(), .transmitter = options_.name, .nonce = getpid()});
      call += kCall;
    }
    wait(std::min(call, begin + kLook) - steady());
    if (status_ > 0) return status_;
    if (signals_.stops() > 0) return 0;
  }
  looking_ = false;
  log(options_.name + " waits for orders on " + options_.url + "; " + describe(mind_.allowed()));
  systemd_.ready(options_.name + " waits for orders; " + describe(mind_.allowed()));
  jiffies_ = jiffies();
  double next = steady();
  while (signals_.stops() == 0) {
    const double now = steady();
    mind_.tick(now);
    act();
    if (now >= next) {
      measure(now);
      next = std::max(next + 1.0, now);
      tell_now_ = true;
    }
    if (std::exchange(asked_, false)) tell_allowed();  // in front: who asks may listen for no longer than to the answer
    if (mind_.take_changed() || std::exchange(tell_now_, false)) tell();
    flush(now);
    wait(std::min(next - now, mind_.idle(now)));
  }
  systemd_.stopping();
  return leave();
}

int Service::leave() {
  log("stops everything");
  mind_.shut_down(steady());
  act();
  for (bool killed = false; !mind_.over();) {
    wait(std::min(0.1, mind_.idle(steady())));
    if (signals_.stops() > 1 && !std::exchange(killed, true)) {
      for (const CommandStatus& each : mind_.info(0).commands) children_.signal(each.command.id, SIGKILL);
    }
    mind_.tick(steady());
    act();
    if (mind_.take_changed()) tell();
    flush(steady());
  }
  return 0;
}

}  // namespace fathom::deputy

#include "processes/sheriff/office.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fathom_lcm/health_t.hpp>
#include <fstream>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>
#include <sstream>
#include <utility>

#include "common/base/error.hpp"
#include "common/launch/allow_list.hpp"
#include "common/runtime/self.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/launch.hpp"
#include "common/wire/minds.hpp"

namespace fathom::sheriff {
namespace {

Utime wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}
double steady() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

constexpr double kListen = 1.3;      // s: every deputy speaks once a second
constexpr double kListenHere = 0.4;  // s, where silence means no more than that we start one: two settle it themselves
constexpr double kLocalPatience = 10.0;   // s until a deputy of our own speaks: liblcm may test itself that long
constexpr double kAnswer = 2.0;           // s that a deputy, on a busy machine, may take to say what it may run
constexpr double kCall = 0.5;             // s between two calls for a deputy that is silent
constexpr double kSettle = 1.5;           // s after a script: what ends at once is seen to end
constexpr std::size_t kLastWords = 2000;  // B that are kept of what a command prints

/// The last three lines of what a program printed.
void tell_last_words(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream{text};
  for (std::string line; std::getline(stream, line);) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    if (!line.empty()) lines.push_back(line);
  }
  for (std::size_t i = lines.size() > 3 ? lines.size() - 3 : 0; i < lines.size(); ++i) {
    std::printf("  %s\n", lines[i].c_str());
  }
}

std::string own_name() {
  return runtime::host_name() + ":" + std::to_string(getpid()) + ":" + std::to_string(wall_clock());
}

}  // namespace

Office::Office(Options options, launch::LaunchConfig config)
    : options_{std::move(options)},
      mind_{own_name(), std::move(config)},
      procman_{{runtime::Url::parse(options_.url, "--lcmurl")},
               {{wire::kLaunchInfo, 100}, {wire::kLaunchOrders, 100}, {wire::kLaunchOutput, 1000}}},
      health_input_{{runtime::Url::parse(options_.health_url, "LCM_DEFAULT_URL")}, {{wire::kHealth, 1000}}},
      output_{runtime::Url::parse(options_.url, "--lcmurl")} {}

void Office::hear() {
  const double now = steady();
  while (const auto message = procman_.next()) {
    if (message->subscription == 0) {
      const auto decoded = runtime::message_of<procman_lcm::deputy_info_t>(message->bytes);
      if (const auto info = decoded ? wire::decode(*decoded) : std::nullopt) mind_.hear(*info, wall_clock(), now);
    } else if (message->subscription == 1) {
      const auto decoded = runtime::message_of<procman_lcm::orders_t>(message->bytes);
      if (const auto orders = decoded ? wire::decode(*decoded) : std::nullopt) mind_.hear(*orders, now);
    } else {
      const auto decoded = runtime::message_of<procman_lcm::output_t>(message->bytes);
      const auto output = decoded ? wire::decode(*decoded) : std::nullopt;
      if (!output) continue;
      for (const LaunchOutput::Text& each : output->texts) {
        std::string& words = printed_[each.id];
        words += each.text;
        if (words.size() > kLastWords) words.erase(0, words.size() - kLastWords);
        keep(each.id.empty() ? output->deputy : each.id, each.text);
        // What a deputy may run is of interest to who asks for the state, once.
        const bool allowed = each.id.empty() && each.text.starts_with(launch::kAllowed);
        if (allowed && (!options_.status || std::exchange(allowed_[output->deputy], each.text) == each.text)) continue;
        if (!options_.verbose && !each.id.empty()) continue;
        const std::string said = each.text.substr(0, each.text.find_last_not_of("\r\n") + 1);
        screen_.say((each.id.empty() ? output->deputy : each.id) + ": " + said);
      }
    }
  }
  while (const auto message = health_input_.next()) {
    const auto decoded = runtime::message_of<fathom_lcm::health_t>(message->bytes);
    if (decoded && !speakers_.believes(*decoded)) continue;
    if (const auto health = decoded ? wire::decode(*decoded) : std::nullopt) health_.hear(*health, now);
  }
}

// A name comes from the bus: it must not lead out of the folder.
void Office::keep(const std::string& command, const std::string& text) {
  if (options_.logs.empty() || command.find('/') != std::string::npos || command.starts_with('.')) return;
  std::ofstream file{options_.logs + "/" + command + ".txt", std::ios::app | std::ios::binary};
  std::string plain = text;
  std::erase(plain, '\r');
  file << plain;
}

void Office::round() {
  std::vector<pollfd> watched{{.fd = interrupt_.descriptor(), .events = POLLIN, .revents = 0}};
  for (const int each : procman_.descriptors()) watched.push_back({.fd = each, .events = POLLIN, .revents = 0});
  for (const int each : health_input_.descriptors()) watched.push_back({.fd = each, .events = POLLIN, .revents = 0});
  poll(watched.data(), watched.size(), 50);
  hear();
  const double now = steady();
  if (mind_.take_changed() || now >= next_order_) {
    next_order_ = now + 1.0;
    for (const LaunchOrders& orders : mind_.orders(wall_clock())) {
      runtime::say(output_, wire::kLaunchOrders, wire::encode(orders));
    }
  }
  // Whoever comes back answers at once, and not only to the first call: the link may be bad as well.
  if (now >= next_call_ && !everybody_heard()) {
    next_call_ = now + kCall;
    call();
  }
  const std::string rival = mind_.rival(now);
  if (rival != rival_told_ && !rival.empty()) {
    screen_.say("another sheriff gives orders too: " + rival + "; the last order wins, so stop one of the two");
  }
  rival_told_ = rival;
  if (!options_.status) screen_.show(mind_.rows(now), health_, doing_, now);
}

void Office::rounds(double seconds) {
  for (const double end = steady() + seconds; steady() < end && !interrupt_.raised();) round();
}

bool Office::everybody_heard() const { return mind_.unheard_deputies(steady()).empty(); }

void Office::call() {
  runtime::say(output_, wire::kLaunchDiscover,
               wire::encode(LaunchDiscovery{.utime = wall_clock(), .transmitter = own_name(), .nonce = 0}));
}

// Nothing is ordered before the deputies have said what runs: that is adopted, not restarted.
void Office::gather() {
  call();
  const double listen = options_.local ? kListenHere : kListen;
  for (const double end = steady() + listen; steady() < end && !everybody_heard() && !interrupt_.raised();) round();
  if (!options_.local) return;
  for (const std::string& each : mind_.unheard_deputies(steady()))
    local_.start(each, options_.url, mind_.config().path);
  for (const double end = steady() + kLocalPatience; steady() < end && !everybody_heard() && !interrupt_.raised();) {
    round();
  }
}

bool Office::play(const launch::Script& script, launch::ScriptRun::Care care) {
  const auto ready = [&](const launch::Sheriff::Row& row) {
    return row.command.exec.find("fathom-") == std::string::npos || !health_.of(row, steady()).state.empty();
  };
  launch::ScriptRun run{mind_, script, care, ready};
  const bool stopping = care == launch::ScriptRun::Care::kGoOn;  // not to be interrupted
  auto result = run.step(steady());
  while (result == launch::ScriptRun::Result::kGoing && (stopping || !interrupt_.raised())) {
    if (run.text() != doing_) doing_ = run.text();
    round();
    result = run.step(steady());
  }
  doing_.clear();
  if (result == launch::ScriptRun::Result::kFailed) screen_.say(run.text());
  return result == launch::ScriptRun::Result::kDone;
}

bool Office::stop_all() {
  const launch::Action all{.verb = launch::Action::Verb::kStop, .awaited = launch::Awaited::kStopped};
  const launch::Script everything{.name = "stop", .actions = {all}};
  const launch::Script* own = mind_.config().script("stop");
  return play(own != nullptr ? *own : everything, launch::ScriptRun::Care::kGoOn);
}

int Office::judge(bool well) {
  const double now = steady();
  screen_.finish(mind_.rows(now), health_, now);
  for (const std::string& each : mind_.complaints(now, options_.status)) {
    std::printf("%s\n", each.c_str());
    well = false;
    if (!options_.verbose) tell_last_words(printed_[each.substr(0, each.find(' '))]);
  }
  return well ? 0 : 1;
}

int Office::run() {
  gather();
  const std::vector<std::string> unheard = mind_.unheard_deputies(steady());
  const bool nobody = unheard.size() == mind_.config().deputies().size();
  for (const std::string& each : unheard) {
    screen_.say("deputy " + each + " is not heard on " + options_.url + "; start it there: fathom-deputy --id " + each);
  }
  if (options_.status) {
    // A deputy's usual word may come before its answer to our call, in which it says what it may run; procman's says
    // nothing of it.
    const std::size_t heard = mind_.config().deputies().size() - unheard.size();
    for (const double end = steady() + kAnswer; steady() < end && allowed_.size() < heard && !interrupt_.raised();)
      round();
    return judge(!nobody);
  }
  if (nobody && !options_.local && (options_.stop || !options_.script.empty())) return 1;

  bool well = true;
  if (options_.stop) {
    well = stop_all();
    rounds(0.3);
    return judge(well);
  }
  if (!options_.script.empty()) {
    well = play(mind_.config().require_script(options_.script), launch::ScriptRun::Care::kGiveUp);
    const auto rows = mind_.rows(steady());
    const bool any = std::any_of(rows.begin(), rows.end(), [](const auto& each) { return each.wanted; });
    if (any || !well) rounds(kSettle);  // last words come behind an end
  }
  if (well && (options_.stay || options_.script.empty())) {
    while (!interrupt_.raised()) round();
  }
  const bool interrupted = interrupt_.raised();
  int status = judge(well);
  if (local_.any()) {
    if (interrupted) screen_.say("stops all in order");
    if (!stop_all() && status == 0) status = 1;
    local_.stop();
    screen_.clear();
  }
  const bool watching = options_.stay || options_.script.empty();  // its end is an interrupt
  return interrupted && !watching ? 130 : status;
}

}  // namespace fathom::sheriff

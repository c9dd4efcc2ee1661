#include "common/runtime/process.hpp"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <algorithm>
#include <chrono>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/process_info_t.hpp>
#include <fstream>
#include <iostream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/version.hpp"
#include "common/runtime/process_state.hpp"

namespace fathom::runtime {
namespace {

constexpr Utime kRestartJump = 1'000'000;        // us; devices are late by less
constexpr std::chrono::seconds kInfoPeriod{30};  // of PROCESS_INFO on a live bus, for whoever came later
constexpr int kWaitMs = 50;                      // half of the promised 100 ms, should a signal miss the descriptor
constexpr char kInfoChannel[] = "PROCESS_INFO";

/// What a configuration file says. An operator's word is not for the bus, nor for logs.
std::string content(const std::string& path) {
  const std::string head = "# file " + path;
  if (Config::load(path).has("operator")) return head + ": not told, since it holds the operator's key\n";
  std::ifstream file{path};
  std::string text = head + "\n";
  for (std::string line; std::getline(file, line);) text += line + "\n";
  return text;
}

template <class Channels>
auto find_channel(Channels& channels, const std::string& channel) {
  return std::find_if(channels.begin(), channels.end(), [&](const auto& each) { return each.channel == channel; });
}

}  // namespace

Process::Process(std::string name, Arguments arguments)
    : state_{new State{.name = name,
                       .arguments = std::move(arguments),
                       .logger = {name, std::make_shared<spdlog::sinks::stderr_color_sink_st>()}}} {
  state_->logger.set_pattern("%H:%M:%S.%e %n %^%l%$: %v");
  state_->logger.set_level(spdlog::level::from_str(state_->arguments.log_level));
}

Process::~Process() = default;

void Process::add_hearing(const std::string& channel, const std::string& type, std::size_t capacity, Deliver deliver) {
  if (find_channel(state_->hearings, channel) != state_->hearings.end()) {
    throw std::logic_error("two handlers for channel " + channel);
  }
  state_->hearings.push_back({channel, type, capacity, std::move(deliver), {}, 0});
}

void Process::add_speech(const std::string& channel, const std::string& type) {
  state_->speeches.push_back({channel, type});
}

void Process::on_restart(std::function<void()> callback) { state_->restart = std::move(callback); }
void Process::on_real_time(std::function<void(double)> callback) { state_->real_time = std::move(callback); }
void Process::on_end(std::function<void()> callback) { state_->end = std::move(callback); }
void Process::waits_with(Wait wait) { state_->wait = std::move(wait); }
void Process::stop() { state_->ended = true; }
void Process::overhears(Overhear overhear) { state_->overhear = std::move(overhear); }
void Process::on_health(std::function<Condition()> ask) { state_->condition = std::move(ask); }
void Process::goes_by(const std::string& name) {
  state_->known_as = name;
  state_->twins = Twins{name, state_->host, getpid()};
}
void Process::tell_health() { report_health("running", ""); }
void Process::log_info(const std::string& text) { state_->logger.info(text); }
void Process::log_warning(const std::string& text) { state_->logger.warn(text); }

void Process::reject(const std::string& channel) {
  const auto hearing = find_channel(state_->hearings, channel);
  if (hearing == state_->hearings.end()) throw std::logic_error("reject on unheard channel " + channel);
  ++hearing->rejected;
}

Config Process::config() {
  std::optional<Config> found;
  for (const std::string& path : state_->arguments.config) {
    const Config file = Config::load(path);
    if (!file.has(state_->name)) continue;
    if (found) throw InputError(file.where(state_->name) + ": a second section " + state_->name + "; keep one");
    found = file.section(state_->name);
  }
  if (!found) throw InputError("no --config file has a section " + state_->name + "; give one of config/pipelines");
  state_->sections.push_back(*found);
  return *found;
}

std::string Process::config_path(const std::string& key) const {
  std::string found;
  for (const std::string& path : state_->arguments.config) {
    if (!Config::load(path).has(key)) continue;
    if (!found.empty()) throw InputError(path + ": " + found + " has the key " + key + " too; give one of them");
    found = path;
  }
  if (found.empty()) throw InputError("no --config file has the key " + key + "; add the file that has it");
  return found;
}

bool Process::has_config(const std::string& key) const {
  return std::ranges::any_of(state_->arguments.config,
                             [&](const std::string& path) { return Config::load(path).has(key); });
}

bool Process::go_on() {
  if (state_->out && state_->out->live() && Clock::now() - state_->last_health >= std::chrono::seconds{1})
    report_health("running", "");
  return !state_->stop->raised();
}

bool Process::reads_logs() const { return !state_->arguments.lockstep && !state_->arguments.in.front().live(); }
bool Process::is_live() const { return !state_->arguments.lockstep && state_->arguments.in.front().live(); }

void Process::send(const std::string& channel, const std::string& type, Utime utime) {
  const auto speech = find_channel(state_->speeches, channel);
  if (speech == state_->speeches.end() || speech->type != type) {
    throw std::logic_error("publish of " + type + " on channel " + channel + " was not declared");
  }
  if (!state_->out) throw std::logic_error("publish before run()");
  state_->out->write(channel, buffer_, utime);
  ++state_->published;
  if (state_->follower) state_->follower->said(channel, buffer_);
  if (state_->overhear) state_->overhear(channel, buffer_);
}

// Channels are judged one by one: an operator's clock may differ from a replayed log's. After a jump all begin anew, so
// that one restart of a log is one call.
void Process::arrived(const std::string& channel, Utime utime) {
  introduce(utime);
  auto& newest = find_channel(state_->hearings, channel)->newest;
  if (newest && utime < *newest - kRestartJump) {
    state_->logger.info("time jumped back on {}: starting over", channel);
    for (Hearing& hearing : state_->hearings) hearing.newest.reset();
    if (state_->restart) state_->restart();
  }
  newest = std::max(utime, newest.value_or(utime));
}

void Process::deliver(std::size_t index, std::span<const std::uint8_t> bytes) {
  Hearing& hearing = state_->hearings[index];
  const auto begin = Clock::now();
  ++hearing.arrived;
  hearing.last = begin;
  if (hearing.deliver(bytes)) {
    ++state_->received;
  } else if (hearing.rejected++ == 0) {
    state_->logger.warn(
        "{}: not a {} of this version, or with a time that no clock shows; is every process of the same build?",
        hearing.channel, hearing.type);
  }
  state_->busy += Clock::now() - begin;
}

void Process::introduce(Utime utime) {
  if (std::exchange(state_->introduced, true)) return;
  fathom_lcm::process_info_t info{};
  info.utime = utime;
  info.process = state_->name;
  info.version = version();
  for (const std::string& path : state_->arguments.config) info.config += content(path);
  info.channels = interface_text();
  publish(kInfoChannel, info);
}

std::string Process::interface_text() const {
  std::string text;
  for (const Hearing& each : state_->hearings) text += "hears " + each.channel + " " + each.type + "\n";
  for (const Speech& each : state_->speeches) text += "says " + each.channel + " " + each.type + "\n";
  return text;
}

void Process::run() {
  publishes<fathom_lcm::health_t>(kHealthChannel);
  publishes<fathom_lcm::process_info_t>(kInfoChannel);
  if (state_->arguments.interface_only) {
    std::cout << interface_text() << std::flush;
    return;
  }
  for (const Config& section : state_->sections) section.finish();
  state_->stop.emplace();
  state_->last_health = Clock::now();
  try {
    if (state_->arguments.lockstep) {
      run_lockstep();
    } else if (state_->arguments.in.front().live()) {
      run_live();
    } else {
      run_logs();
    }
    if (state_->end) state_->end();
    report_health("stopped", "");
    state_->out->finish();
  } catch (const std::exception& error) {
    report_health("fault", error.what());
    throw;
  }
}

void Process::run_logs() {
  MergedLogs logs{state_->arguments.in};
  state_->out.emplace(state_->arguments.out);
  std::optional<LogEvent> event;
  while (!state_->stop->raised() && (event = logs.next())) {
    const auto& hearings = state_->hearings;
    const auto found = std::find_if(hearings.begin(), hearings.end(),
                                    [&](const Hearing& hearing) { return hearing.channel == event->channel; });
    if (found != hearings.end()) deliver(static_cast<std::size_t>(found - hearings.begin()), event->data);
    if (state_->out->live() && Clock::now() - state_->last_health >= std::chrono::seconds{1})
      report_health("running", "");
  }
  for (const std::string& warning : logs.warnings()) state_->logger.warn(warning);
  for (const Hearing& hearing : state_->hearings) {
    if (hearing.rejected > 0) state_->logger.warn("{}: {} messages rejected", hearing.channel, hearing.rejected);
  }
}

void Process::run_live() {
  std::vector<Subscription> subscriptions;
  for (const Hearing& hearing : state_->hearings) subscriptions.push_back({hearing.channel, hearing.capacity});
  const std::size_t everybody = subscriptions.size();
  subscriptions.push_back({kHealthChannel, kEverybody});
  state_->out.emplace(state_->arguments.out);
  state_->live.emplace(state_->arguments.in, subscriptions);
  introduce(wall_clock());
  auto introduced = Clock::now();
  report_health("running", "");  // whoever waits until it hears need not wait a second
  Clock::time_point last_call{};
  while (!state_->stop->raised() && !state_->ended) {
    if (!state_->wait) {
      state_->live->wait(state_->stop->descriptor(), kWaitMs);
    } else {
      std::vector<int> descriptors = state_->live->descriptors();
      descriptors.push_back(state_->stop->descriptor());
      state_->wait(descriptors, state_->live->pending() ? 0 : kWaitMs);
    }
    if (const auto message = state_->live->next()) {
      if (message->subscription < everybody) {
        deliver(message->subscription, message->bytes);
      } else {
        watch_twins(message->bytes);
      }
    }
    const auto now = Clock::now();
    if (state_->real_time && now - last_call >= std::chrono::milliseconds{100}) {
      last_call = now;
      state_->real_time(std::chrono::duration<double>(now.time_since_epoch()).count());
    }
    if (now - state_->last_health >= std::chrono::seconds{1}) report_health("running", "");
    if (now - introduced >= kInfoPeriod) {
      introduced = now;
      state_->introduced = false;
      introduce(wall_clock());
    }
  }
}

// As run_live(), but messages wait until the simulator announces the phase that they belong to.
void Process::run_lockstep() {
  constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();  // even "latest" channels keep every message
  std::vector<Subscription> subscriptions{{kLockstep, kAll}};
  std::vector<std::string> heard;
  std::vector<std::size_t> hearing_of{0};  // by subscription
  for (const Hearing& hearing : state_->hearings) {
    if (travels_alone(hearing.channel)) {
      subscriptions.push_back({hearing.channel, kAll});
      hearing_of.push_back(heard.size());
    }
    heard.push_back(hearing.channel);
  }
  state_->follower.emplace(state_->name, heard);
  Follower& follower = *state_->follower;
  state_->out.emplace(state_->arguments.out);
  state_->live.emplace(state_->arguments.in, subscriptions);
  const auto tell = [&](const fathom_lcm::lockstep_ack_t& ack) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(ack.getEncodedSize()));
    ack.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    state_->out->write(kLockstepAck, bytes, ack.utime);
  };
  introduce(wall_clock());
  auto last_hello = Clock::now();
  tell(follower.hello());
  report_health("running", "");
  while (!state_->stop->raised() && !state_->ended) {
    state_->live->wait(state_->stop->descriptor(), kWaitMs);
    while (auto message = state_->live->next()) {
      if (message->subscription > 0) {
        follower.arrived(hearing_of[message->subscription], std::move(message->bytes));
        continue;
      }
      fathom_lcm::lockstep_t phase{};
      const int length = static_cast<int>(message->bytes.size());
      if (phase.decode(message->bytes.data(), 0, length) == length) follower.announced(phase);
    }
    while (const auto phase = follower.next()) {
      for (const Follower::Message& message : *phase) deliver(message.hearing, message.bytes);
      tell(follower.answer());
    }
    if (follower.ends()) {
      if (const auto end = std::exchange(state_->end, nullptr)) end();
      tell(follower.answer());
      return;
    }
    const auto now = Clock::now();
    if (!follower.started() && now - last_hello >= std::chrono::milliseconds{200}) {
      last_hello = now;
      tell(follower.hello());
    }
    if (now - state_->last_health >= std::chrono::seconds{1}) report_health("running", "");
  }
}

int main(const Program& program, int argc, const char* const* argv, const std::function<void(Process&)>& setup,
         const std::function<void(CommandLine&)>& more) {
  try {
    auto arguments = Arguments::parse(program, argc, argv, more);
    if (!arguments) return 0;
    Process process{program.name, std::move(*arguments)};
    setup(process);
    return 0;
  } catch (const std::exception& error) {
    spdlog::logger logger{program.name, std::make_shared<spdlog::sinks::stderr_color_sink_st>()};
    logger.set_pattern("%H:%M:%S.%e %n %^%l%$: %v");
    logger.critical(error.what());
    return 1;
  }
}

}  // namespace fathom::runtime

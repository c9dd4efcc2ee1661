// What a process knows while it runs; for the parts of Process alone.
#pragma once

#include <spdlog/logger.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/runtime/arguments.hpp"
#include "common/runtime/bus.hpp"
#include "common/runtime/lockstep.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/self.hpp"
#include "common/runtime/speakers.hpp"
#include "common/runtime/stop_signal.hpp"

namespace fathom::runtime {

using Clock = std::chrono::steady_clock;
inline constexpr char kHealthChannel[] = "HEALTH";

/// [us] since the epoch.
inline Utime wall_clock() {
  using std::chrono::duration_cast;
  return duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

struct Hearing {
  std::string channel;
  std::string type;
  std::size_t capacity{};
  std::function<bool(std::span<const std::uint8_t>)> deliver;
  std::optional<Utime> newest;
  std::int64_t rejected{};
  std::int64_t arrived{};  // since the last HEALTH
  std::optional<Clock::time_point> last{};
};

struct Speech {
  std::string channel;
  std::string type;
};

struct Process::State {
  std::string name;
  Arguments arguments;
  spdlog::logger logger;
  std::vector<Hearing> hearings{};
  std::vector<Speech> speeches{};
  std::vector<Config> sections{};  // handed out by config(), to be checked for unread keys
  std::function<void()> restart{};
  std::function<void()> end{};
  std::function<void(double)> real_time{};
  Wait wait{};
  Overhear overhear{};
  std::function<Condition()> condition{};
  bool ended{false};
  std::optional<StopSignal> stop{};
  std::optional<LiveInput> live{};
  std::optional<Output> out{};
  std::optional<Follower> follower{};
  bool introduced{false};
  std::int64_t received{};
  std::int64_t published{};
  Clock::duration busy{};  // in handlers, since the last HEALTH
  Clock::time_point begun{Clock::now()};
  Clock::time_point last_health{};
  std::string host{host_name()};
  std::int64_t start{process_start(getpid()).value_or(0)};
  std::int64_t words{};  // HEALTH said so far
  Usage usage{};
  std::string known_as{name};
  Twins twins{name, host, getpid()};
};

}  // namespace fathom::runtime

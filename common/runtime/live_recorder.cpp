#include "common/runtime/live_recorder.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <fathom_lcm/health_t.hpp>
#include <filesystem>
#include <limits>

#include "common/base/error.hpp"
#include "common/runtime/stop_signal.hpp"

namespace fathom::runtime {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWaitMs = 50;
constexpr std::chrono::milliseconds kKeepPeriod{200};  // what a loss of power may cost

std::string numbered(const std::string& path) {
  constexpr unsigned kMost = 1000;
  char end[16];
  for (unsigned i = 0; i < kMost; ++i) {
    std::snprintf(end, sizeof end, ".%02u", i);
    if (!std::filesystem::exists(path + end)) return path + end;
  }
  throw InputError(path + ": numbers up to 999 are taken; move the old logs away");
}

}  // namespace

RecorderHealth::RecorderHealth(Output& bus) : bus_{bus} { (void)usage_.measure(); }

void RecorderHealth::tell(std::int64_t written) {
  const auto now = Clock::now();
  if (now - last_ < std::chrono::seconds{1}) return;
  last_ = now;
  say_health("running", std::to_string(written) + " messages written");
}

void RecorderHealth::end(const std::string& state, const std::string& reason) { say_health(state, reason); }

void RecorderHealth::say_health(const std::string& state, const std::string& detail) {
  using std::chrono::duration_cast;
  fathom_lcm::health_t health{};
  const Usage::Figures used = usage_.measure();
  health.utime = duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  health.process = "recorder";
  health.host = host_name();
  health.pid = getpid();
  health.state = state;
  health.received = received_;
  health.cpu = used.cpu;
  health.memory = used.memory;
  health.detail = detail;
  say(bus_, "HEALTH", health);
}

void record_live(const std::vector<Url>& in, const Url& out, const std::string& path, bool number,
                 const std::vector<std::string>& without) {
  StopSignal stop;
  Output log{Url::parse("file://" + (number ? numbered(path) : path), "--file")};
  Output bus{out};
  LiveInput live{in, {{".*", std::numeric_limits<std::size_t>::max()}}};
  RecorderHealth health{bus};
  std::int64_t written = 0;
  auto kept = Clock::now();
  const auto write = [&] {
    while (auto message = live.next()) {
      health.heard();
      if (message->channel == "LCM_SELF_TEST" || std::ranges::find(without, message->channel) != without.end())
        continue;
      log.write(message->channel, message->bytes, message->received);
      ++written;
    }
  };
  try {
    while (!stop.raised()) {
      live.wait(stop.descriptor(), kWaitMs);
      write();
      health.tell(written);
      if (Clock::now() - kept < kKeepPeriod) continue;
      log.keep();
      kept = Clock::now();
    }
    write();
    log.keep();
  } catch (const std::exception& error) {  // a full disk: who watches shall know at once
    health.end("fault", error.what());
    throw;
  }
  health.end("stopped", std::to_string(written) + " messages written");
}

}  // namespace fathom::runtime

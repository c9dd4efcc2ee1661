// The runtime on a live bus with a port of its own: messages pass, health is told, queues count, a signal stops.
#include <doctest/doctest.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/process_info_t.hpp>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <thread>

#include "common/runtime/process.hpp"

namespace fathom {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

std::string own_bus() {
  return "udpm://239.255.76.67:" + std::to_string(20000 + getpid() % 20000) + "?ttl=0&recv_buf_size=2097152";
}

// What the world outside hears from the process.
struct Listener {
  std::vector<fathom_lcm::health_t> health;
  int infos{};
  int depths{};
};
using Buffer = lcm::ReceiveBuffer;
void on_health(const Buffer*, const std::string&, const fathom_lcm::health_t* message, Listener* listener) {
  listener->health.push_back(*message);
}
void on_info(const Buffer*, const std::string&, const fathom_lcm::process_info_t*, Listener* listener) {
  ++listener->infos;
}
void on_depth(const Buffer*, const std::string&, const fathom_lcm::depth_t*, Listener* listener) { ++listener->depths; }

struct Outcome {
  int code{-1};
  Clock::duration stop_time{};
  int depths{};
  std::int64_t last_battery{};
  int batteries{};
  int ends{};
};

// A process in a thread: its handler of the first message lasts until `sent`, then it echoes DEPTH. `traffic` talks to
// it and sets `sent`; then it is stopped.
Outcome converse(lcm::LCM& bus, bool throws, const std::function<void(std::atomic<bool>& sent)>& traffic) {
  Outcome outcome;
  std::atomic<bool> started{false};
  std::atomic<bool> sent{false};
  const std::string url = own_bus();
  const std::vector<const char*> argv{"echo", "--in", url.c_str(), "--log-level", "off"};
  std::thread thread{[&] {
    outcome.code = runtime::main("echo", static_cast<int>(argv.size()), argv.data(), [&](runtime::Process& process) {
      process.publishes<fathom_lcm::depth_t>("ECHO");
      process.on<fathom_lcm::depth_t>(
          "DEPTH", [](const auto& message) { return std::optional{message}; },
          [&](const auto& message) {
            if (throws) throw std::runtime_error("broken handler");
            if (!started.exchange(true)) return;  // says that it hears
            if (outcome.depths++ == 0) sent.wait(false);
            process.publish("ECHO", message);
          });
      process.on_latest<fathom_lcm::battery_t>(
          "BATTERY", [](const auto& message) { return std::optional{message}; },
          [&](const auto& message) {
            ++outcome.batteries;
            outcome.last_battery = message.utime;
          });
      process.on_end([&] { ++outcome.ends; });
      process.run();
    });
    started = true;
  }};
  const fathom_lcm::depth_t hello{};
  while (!started) {
    bus.publish("DEPTH", &hello);
    std::this_thread::sleep_for(20ms);
  }
  traffic(sent);
  const auto begin = Clock::now();
  if (!throws) pthread_kill(thread.native_handle(), SIGTERM);
  thread.join();
  outcome.stop_time = Clock::now() - begin;
  return outcome;
}

void hear(lcm::LCM& bus, Clock::duration time) {
  const auto end = Clock::now() + time;
  while (Clock::now() < end) bus.handleTimeout(10);
}

constexpr auto kSettle = 200ms;     // liblcm's thread takes the last messages from the kernel
constexpr auto kStopLimit = 100ms;  // the promise to procman, which kills after seconds

}  // namespace

TEST_CASE("live: messages pass, health is told once a second, overflow is counted, and a signal stops within 100 ms") {
  lcm::LCM bus{own_bus()};
  if (!bus.good()) {
    MESSAGE("no route to multicast: not tested here");
    return;
  }
  Listener listener;
  bus.subscribeFunction("HEALTH", on_health, &listener);
  bus.subscribeFunction("PROCESS_INFO", on_info, &listener);
  auto* echo = bus.subscribeFunction("ECHO", on_depth, &listener);
  echo->setQueueCapacity(0);
  const Outcome outcome = converse(bus, false, [&](std::atomic<bool>& sent) {
    // While the handler is busy, 1500 messages arrive: 1000 may wait, and of the batteries only the last counts.
    fathom_lcm::depth_t depth{};
    fathom_lcm::battery_t battery{};
    bus.publish("DEPTH", &depth);
    std::this_thread::sleep_for(100ms);
    for (int i = 1; i <= 1500; ++i) {
      bus.publish("DEPTH", &depth);
      if (i % 100 == 0) {
        battery.utime = i;
        bus.publish("BATTERY", &battery);
        std::this_thread::sleep_for(2ms);
      }
    }
    std::this_thread::sleep_for(kSettle);
    sent = true;
    sent.notify_one();
    hear(bus, 1500ms);
  });
  hear(bus, 50ms);
  CHECK(outcome.code == 0);
  CHECK(outcome.ends == 1);
  CHECK(outcome.stop_time < kStopLimit);
  CHECK(outcome.last_battery == 1500);
  CHECK(outcome.batteries == 1);
  CHECK(listener.infos == 1);
  CHECK(listener.depths == outcome.depths);
  REQUIRE(listener.health.size() >= 3);  // at once, after a second, at the end
  const auto &first_second = listener.health[1], &last = listener.health.back();
  CHECK(last.state == "stopped");
  CHECK(last.process == "echo");
  CHECK(last.dropped == 500);
  CHECK(last.detail == "DEPTH dropped 500; BATTERY skipped 14; ");
  CHECK(listener.health.front().state == "running");
  for (const std::string channel : {"DEPTH", "BATTERY"}) {
    const auto heard = std::ranges::find(last.channels, channel, &fathom_lcm::channel_health_t::channel);
    REQUIRE(heard != last.channels.end());
    CHECK(heard->age > 0.0);
    CHECK(heard->age < 60.0);  // s: the test's whole length
  }
  CHECK(std::ranges::any_of(first_second.channels, [](const auto& heard) { return heard.rate > 1.0; }));
  CHECK(first_second.busy > 0.1);
  CHECK(first_second.busy <= 1.0);
}

TEST_CASE("live: an exception in a handler is told as a fault and is exit code 1, it does not tear through liblcm") {
  lcm::LCM bus{own_bus()};
  if (!bus.good()) return;
  Listener listener;
  bus.subscribeFunction("HEALTH", on_health, &listener);
  const Outcome outcome = converse(bus, true, [](std::atomic<bool>&) {});
  hear(bus, 50ms);
  CHECK(outcome.code == 1);
  CHECK(outcome.ends == 0);
  REQUIRE_FALSE(listener.health.empty());
  CHECK(listener.health.back().state == "fault");
  CHECK(listener.health.back().detail == "broken handler");
}

}  // namespace fathom

// A hostile publisher for tests: takes a log's messages, breaks them in every way that a decoder could stumble over,
// and then floods some channels with whole ones. usage: test_hostile URL FLOOD_SECONDS LOG...
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "common/base/event_log.hpp"
#include "common/runtime/bus.hpp"

using namespace fathom;
using Bytes = std::vector<std::uint8_t>;

namespace {

constexpr double kFlood = 10'000.0;  // messages a second
constexpr std::array kFlooded{"AHRS", "STATE", "WRENCH_COMMAND", "OPERATOR", "HEALTH", "PM_INFO"};

void put(Bytes& bytes, std::size_t at, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i) {
    bytes[at + i] = static_cast<std::uint8_t>(value >> (8U * (size - 1 - i)));
  }
}

std::vector<Bytes> broken(const Bytes& whole, std::mt19937& random) {
  constexpr std::size_t kTime = 8;  // behind the fingerprint
  constexpr std::uint64_t kNan = 0x7ff8000000000000, kInfinite = 0x7ff0000000000000, kYear2100 = 4102444800000000;
  std::vector<Bytes> all{{}, Bytes(3, 0xFF), Bytes(70'000, 0xAB)};
  const auto change = [&](std::size_t at, std::uint64_t value, std::size_t size) {
    all.push_back(whole);
    put(all.back(), at, value, size);
  };
  change(0, 0x0123456789abcdef, 8);
  for (const std::uint64_t time :
       {std::uint64_t{0}, std::uint64_t{1}, kYear2100, ~std::uint64_t{0}, ~std::uint64_t{0} >> 1U}) {
    change(kTime, time, 8);
  }
  const std::size_t steps = whole.size() > 600 ? whole.size() / 150 : 4;
  for (std::size_t at = kTime; at + 4 <= whole.size(); at += steps) {
    for (const std::uint64_t length : {0x7FFFFFFFU, 0xFFFFFFFFU, 0x80000000U, 0x00100000U}) change(at, length, 4);
    change(at, kNan, 8);
    change(at, kInfinite, 8);
  }
  for (std::size_t length = 0; length < whole.size(); length += 1 + whole.size() / 40) {
    all.emplace_back(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
  }
  for (int i = 0; i < 30; ++i) change(random() % whole.size(), random(), 1 + random() % 8);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  std::map<std::string, Bytes> messages;
  for (int i = 3; i < argc; ++i) {
    EventLog log{argv[i]};
    while (const auto event = log.next()) {
      Bytes& kept = messages[std::string{event->channel}];
      if (kept.size() <= event->data.size()) kept.assign(event->data.begin(), event->data.end());
    }
  }
  for (const char* channel : kFlooded) {
    if (messages.contains(channel)) continue;
    std::printf("the logs hold no %s to flood with\n", channel);
    return 1;
  }
  runtime::Output bus{runtime::Url::parse(argv[1], "URL")};
  std::mt19937 random{4};
  long sent = 0;
  for (const auto& [channel, whole] : messages) {
    for (Bytes& each : broken(whole, random)) {
      bus.write(channel, each, 0);
      if (++sent % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds{10});
    }
  }
  long flood = 0;
  const double seconds = std::atof(argv[2]);
  for (const char* channel : kFlooded) {
    const auto begin = std::chrono::steady_clock::now();
    for (long count = 0; static_cast<double>(count) < kFlood * seconds; ++flood) {
      bus.write(channel, messages[channel], 0);
      if (++count % 20 != 0) continue;
      std::this_thread::sleep_until(begin + std::chrono::duration<double>(static_cast<double>(count) / kFlood));
    }
  }
  std::printf("%zu channels, %ld broken messages, %ld in the flood\n", messages.size(), sent, flood);
  return 0;
}

// The trial so far as recordings: order of arrival, cuts, and what is kept of a long one.
#include "common/live/heard_trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>

namespace fathom::live {
namespace {

constexpr Utime kStart = 1'700'000'000'000'000, kSecond = 1'000'000;

Utime at(double seconds) { return kStart + static_cast<Utime>(seconds * 1e6); }

std::vector<double> seconds_of(const std::vector<Depth>& stream) {
  std::vector<double> seconds;
  for (const Depth& one : stream) seconds.push_back(1e-6 * static_cast<double>(one.utime - kStart));
  return seconds;
}

}  // namespace

TEST_CASE("heard trial: every stream in the order of its stamps, equal ones as they came, whatever comes first") {
  HeardTrial trial{600.0};
  for (const double t : {0.0, 2.0, 1.0, 130.0, 65.0}) trial.hear(Depth{.utime = at(t), .z = t});
  trial.hear(Depth{.utime = at(1.0), .z = -1.0});
  trial.hear(Battery{.utime = at(0.5), .voltage = 12.0});
  const std::vector<Recording> all = trial.until(at(1e4));
  REQUIRE(all.size() == 1);
  CHECK(seconds_of(all[0].depth) == std::vector{0.0, 1.0, 1.0, 2.0, 65.0, 130.0});
  CHECK(all[0].depth[1].z == 1.0);
  CHECK(all[0].depth[2].z == -1.0);
  CHECK(all[0].battery.size() == 1);
  CHECK(all[0].state.empty());
}

TEST_CASE("heard trial: a cut has what was stamped until then, and nothing later") {
  HeardTrial trial{600.0};
  for (int k = 0; k < 200; ++k) trial.hear(Depth{.utime = at(k), .z = 0.0});
  const std::vector<Recording> cut = trial.until(at(99.0));
  REQUIRE(cut.size() == 1);
  CHECK(cut[0].depth.size() == 100);
  CHECK(cut[0].depth.back().utime == at(99.0));
  CHECK(trial.until(kStart - 60 * kSecond).empty());
}

TEST_CASE("heard trial: of a long one every second minute is kept, then every fourth, each a recording of its own") {
  HeardTrial trial{600.0};
  std::size_t most = 0;
  for (int k = 0; k < 2400; ++k) {
    trial.hear(Depth{.utime = at(k), .z = 0.0});
    std::size_t held = 0;
    for (const Recording& part : trial.until(at(1e5))) held += part.depth.size();
    if (k % 100 == 99) most = std::max(most, held);
    if (k == 599) CHECK(held == 600);
  }
  CHECK(most <= 660);
  const std::vector<Recording> parts = trial.until(at(1e5));
  REQUIRE(parts.size() >= 8);
  CHECK(parts.front().name == "trial");
  CHECK(parts[1].name == "trial from 240 s");
  for (std::size_t i = 1; i < parts.size(); ++i) {
    CHECK(parts[i].depth.front().utime - parts[i - 1].depth.front().utime <= 240 * kSecond);
    CHECK(parts[i].depth.front().utime - parts[i - 1].depth.back().utime > 100 * kSecond);
  }
  // Of a minute that is not kept, what comes late is not either.
  const std::size_t before = parts[1].depth.size();
  trial.hear(Depth{.utime = parts[1].depth.back().utime + 30 * kSecond, .z = 0.0});
  CHECK(trial.until(at(1e5))[1].depth.size() == before);
  trial.reset();
  CHECK(trial.until(at(1e5)).empty());
  trial.hear(Depth{.utime = at(0.0), .z = 0.0});
  CHECK(trial.until(at(1e5)).size() == 1);
}

}  // namespace fathom::live

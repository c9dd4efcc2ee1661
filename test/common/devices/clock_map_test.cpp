// The instrument's clock to the host's: jitter goes, offset and drift stay, jumps are noticed.
#include "common/devices/clock_map.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

using namespace fathom;
using devices::ClockMap;

namespace {

constexpr Utime kStart = 1'700'000'000'000'000;
constexpr double kLatency = 0.005;  // s

// What a driver sees: true times t, a device clock that began at `origin` and runs slow by `ppm`, a line of at least 2
// ms and jitter that is seldom small.
struct Line {
  double origin, ppm;
  std::mt19937 random{4};
  std::exponential_distribution<double> jitter{1.0 / 0.008};
  [[nodiscard]] double device(double t) const { return origin + t * (1.0 - 1e-6 * ppm); }
  [[nodiscard]] Utime arrival(double t) { return utime_after(kStart, t + 0.002 + jitter(random)); }
};

}  // namespace

TEST_CASE("clock map: ten milliseconds of jitter become less than one, with offset and drift unknown") {
  for (const double ppm : {0.0, 40.0, -80.0}) {
    CAPTURE(ppm);
    Line line{.origin = 123.0, .ppm = ppm};
    ClockMap map{kLatency};
    double worst = 0.0;
    double worst_raw = 0.0;
    for (int i = 0; i < 20'000; ++i) {
      const double t = 0.01 * i;
      const Utime arrival = line.arrival(t);
      const Utime utime = map.map(line.device(t), arrival);
      if (t < 40.0) continue;
      worst = std::max(worst, std::abs(seconds_between(kStart, utime) - (t + 0.002 - kLatency)));
      worst_raw = std::max(worst_raw, std::abs(seconds_between(kStart, arrival) - (t + 0.002)));
    }
    CHECK(worst < 0.001);
    CHECK(worst_raw > 0.05);
    REQUIRE(map.drift());
    CHECK(std::abs(*map.drift() - ppm) < 15.0);
    CHECK(map.restarts() == 0);
  }
}

TEST_CASE(
    "clock map: a clock that tells hundredths, rounded or cut off, is right in the mean and never off by more than "
    "half") {
  constexpr double kTick = 0.01, kSlack = 5e-4;
  for (const double rounding : {0.0, 0.5}) {
    Line line{.origin = 123.0, .ppm = 40.0};
    ClockMap map{kLatency, kTick};
    double worst = 0.0, sum = 0.0;
    int count = 0;
    for (int i = 0; i < 4000; ++i) {
      const double t = 0.1271 * i;
      const double told = kTick * std::floor(line.device(t) / kTick + rounding);
      const Utime utime = map.map(told, utime_after(kStart, t + kLatency));
      if (t < 60.0) continue;
      const double error = seconds_between(kStart, utime) - t;
      worst = std::max(worst, std::abs(error));
      sum += error;
      ++count;
    }
    CHECK(worst < 0.5 * kTick + kSlack);
    CHECK(std::abs(sum / count) < kSlack);
  }
}

TEST_CASE("clock map: an instrument that starts anew is counted and mapped anew") {
  Line line{.origin = 5000.0, .ppm = 10.0};
  ClockMap map{0.0};
  for (int i = 0; i < 500; ++i) (void)map.map(line.device(0.01 * i), line.arrival(0.01 * i));
  line.origin = -5.0;  // its clock begins at zero again
  for (int i = 500; i < 1000; ++i) {
    const Utime arrival = line.arrival(0.01 * i);
    const Utime utime = map.map(line.device(0.01 * i), arrival);
    CHECK(seconds_between(arrival, utime) < 0.05);  // behind what was said before the restart, times must rise
    CHECK(seconds_between(utime, arrival) < 0.2);
  }
  CHECK(map.restarts() == 1);
}

TEST_CASE("clock map: a counter that runs over and a time of day at midnight are no restart, and drift stays known") {
  constexpr double kDay = 86400.0;
  Line line{.origin = kDay - 50.0, .ppm = 40.0};
  ClockMap map{kLatency, 0.0, kDay};
  double worst = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    const double t = 0.01 * i;
    const Utime utime = map.map(std::fmod(line.device(t), kDay), line.arrival(t));
    if (t > 40.0) worst = std::max(worst, std::abs(seconds_between(kStart, utime) - (t + 0.002 - kLatency)));
    if (t > 40.0) CHECK(map.drift());
  }
  CHECK(worst < 0.001);
  CHECK(map.restarts() == 0);
  line.origin = -100.0;  // switched on anew
  (void)map.map(line.device(100.0), line.arrival(100.0));
  CHECK(map.restarts() == 1);
}

TEST_CASE("clock map: times rise, whatever the line does, and without device time the arrival counts") {
  Line line{.origin = 0.0, .ppm = 0.0};
  ClockMap map{kLatency};
  Utime last = 0;
  for (int i = 0; i < 2000; ++i) {
    const Utime utime = map.map(line.device(0.01 * i), line.arrival(0.01 * i));
    CHECK(utime > last);
    last = utime;
  }
  ClockMap plain{kLatency};
  CHECK(plain.map(std::nullopt, kStart) == kStart - 5000);
  CHECK(plain.map(std::nullopt, kStart) == kStart - 4999);  // two frames of one read
}

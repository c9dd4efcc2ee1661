// When pictures were taken, from when they arrived.
#include "common/pictures/camera_clock.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace fathom::pictures {
namespace {

constexpr double kLeastDelay = 0.05;  // s
constexpr double kLatest = 0.028;     // s

Utime stamp_of(CameraClock& clock, Utime arrival) {
  const auto stamp = clock.step(arrival);
  REQUIRE(stamp);
  return *stamp;
}

struct Errors {
  double worst_stamp{}, rms_arrival{}, rms_stamp{}, mean_interval_error{};  // s; the last one of 1/interval, as a share
  int unsteady{}, left_out{};
};

/// A camera of `rate` whose pictures come exponentially late, by kLatest at most, a share of them never; a clock that
/// is told `stated`.
Errors run(double rate, double stated, double lateness, double lost, int n, unsigned seed) {
  std::mt19937 random{seed};
  std::exponential_distribution<double> late{1.0 / lateness};
  std::uniform_real_distribution<double> chance;
  CameraClock clock{stated};
  Errors errors;
  double arrived = 0.0, stamped = 0.0, taken_before = 0.0;
  int counted = 0, pairs = 0;
  for (int i = 0; i < n; ++i) {
    const double taken = i / rate;
    if (chance(random) < lost) continue;
    arrived = std::max(arrived + 1e-4, taken + kLeastDelay + std::min(late(random), kLatest));  // in order
    const auto utime = clock.step(utime_after(1'000'000, arrived));
    errors.left_out += utime ? 0 : 1;
    if (!utime) continue;
    const double stamp = seconds_between(1'000'000, *utime) - kLeastDelay;
    errors.unsteady += clock.steady() ? 0 : 1;
    if (i > n / 4) {
      errors.worst_stamp = std::max(errors.worst_stamp, std::abs(stamp - taken));
      errors.rms_stamp += std::pow(stamp - taken, 2);
      errors.rms_arrival += std::pow(arrived - kLeastDelay - taken, 2);
      errors.mean_interval_error += (taken - taken_before) / (stamp - stamped) - 1.0;
      ++pairs;
      ++counted;
    }
    stamped = stamp;
    taken_before = taken;
  }
  errors.rms_stamp = std::sqrt(errors.rms_stamp / counted);
  errors.rms_arrival = std::sqrt(errors.rms_arrival / counted);
  errors.mean_interval_error /= pairs;
  return errors;
}

}  // namespace

TEST_CASE("camera clock: pictures that come late are stamped when they were taken") {
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    for (const double lateness : {1e-3, 4e-3, 8e-3}) {
      const Errors e = run(29.97, 30.0, lateness, 0.03, 2000, seed);
      MESSAGE("late by " << lateness << " s: rms of arrivals " << e.rms_arrival << ", of stamps " << e.rms_stamp
                         << ", worst " << e.worst_stamp << ", mean of 1/interval " << e.mean_interval_error);
      CHECK(e.rms_arrival > 1.2 * lateness);
      CHECK(e.rms_stamp < 0.05 * e.rms_arrival);
      CHECK(std::abs(e.mean_interval_error) < 1e-3);  // a velocity's scale
      CHECK(e.unsteady == 0);
      CHECK(e.left_out == 0);
    }
  }
}

TEST_CASE("camera clock: exact arrivals stay as they are, whatever is missing") {
  CameraClock clock{30.0};
  for (int i = 0; i < 500; ++i) {
    if (i % 7 == 3 || (i > 100 && i < 130) || (i > 200 && i < 300)) continue;
    const Utime arrival = utime_after(5'000'000, i / 30.0);
    CHECK(std::abs(stamp_of(clock, arrival) - arrival) <= 2);
  }
  // Every second one alone: exposures became longer.
  for (int i = 500; i < 700; i += 2) {
    const Utime arrival = utime_after(5'000'000, i / 30.0);
    CHECK(std::abs(stamp_of(clock, arrival) - arrival) <= 2);
  }
}

TEST_CASE("camera clock: another rate than stated is noticed, and pictures are stamped as they come") {
  for (const double rate : {24.0, 25.0, 27.0, 29.0, 50.0}) {
    const Errors e = run(rate, 30.0, 1e-3, 0.0, 1000, 3);
    CHECK(e.unsteady > 700);
    CHECK(e.left_out < 20);
    CHECK(e.worst_stamp < 0.02);
  }
}

TEST_CASE("camera clock: one that restarts, or whose arrivals go back, begins anew") {
  CameraClock clock{30.0};
  for (int i = 0; i < 100; ++i) static_cast<void>(stamp_of(clock, utime_after(0, i / 30.0)));
  CHECK(stamp_of(clock, utime_after(0, 60.013)) == utime_after(0, 60.013));
  CHECK(stamp_of(clock, utime_after(0, 60.013 + 1 / 30.0 + 0.004)) < utime_after(0, 60.013 + 1 / 30.0 + 0.001));
  CHECK(stamp_of(clock, utime_after(0, 59.0)) == utime_after(0, 59.0));
  CHECK_FALSE(clock.step(utime_after(0, 59.0)));  // twice the same
}

TEST_CASE("camera clock: a delay of a whole period and more costs that picture, not the next ones") {
  CameraClock clock{30.0};
  double worst = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double taken = i / 30.0, delay = i == 150 ? 0.05 : (i == 151 ? 0.0168 : 0.001 * (i % 5));
    const auto stamp = clock.step(utime_after(0, taken + delay));
    CHECK_MESSAGE((stamp.has_value() || i == 151), i);
    if (!stamp) continue;
    const double error = seconds_between(0, *stamp) - taken;
    if (i > 60 && i != 150 && i != 151) worst = std::max(worst, std::abs(error));
  }
  CHECK(worst < 0.005);
}

}  // namespace fathom::pictures

// Differences of times: the same as of integers wherever there is a time, and no overflow where there is none.
#include "common/base/time.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <random>

using namespace fathom;

TEST_CASE("time: differences are those of integers, to the bit") {
  std::mt19937_64 random{7};
  std::uniform_int_distribution<Utime> any{-kLatest + 1, kLatest - 1},
      now{1'700'000'000'000'000, 1'800'000'000'000'000};
  for (int i = 0; i < 10'000; ++i) {
    const Utime a = now(random), b = now(random);
    CHECK(seconds_between(a, b) == static_cast<double>(b - a) * 1e-6);
    CHECK(is_time(any(random)));
  }
}

TEST_CASE("time: what no clock shows overflows nothing and is no time") {
  constexpr Utime kMost = std::numeric_limits<Utime>::max(), kLeast = std::numeric_limits<Utime>::min();
  CHECK(seconds_between(-1, kMost) > 9e12);
  CHECK(seconds_between(kMost, kLeast) < -1e13);
  CHECK_FALSE(is_time(kMost));
  CHECK_FALSE(is_time(kLeast));
  CHECK(is_time(0));
}

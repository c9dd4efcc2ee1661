// Speeds that step between slow samples are motion; what leaves and comes back is not.
#include "common/estimation/spikes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace fathom {

using estimation::Series;

namespace {

constexpr double kStep = 0.1;   // s
constexpr double kFloor = 0.1;  // rad/s

/// Yaw rate that answers random steps of thrust, far apart, with the given time constant [s], at 10 Hz; noise 1 mrad/s.
Series stepping(double time_constant, unsigned seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> noise{0.0, 1e-3};
  std::uniform_real_distribution<double> level{-1.0, 1.0}, when{0.0, 1.0};
  Series rate;
  double r = 0.0, wanted = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const double rest = when(random);  // the step comes somewhere between two samples
    if (k % 40 == 20) {
      r = wanted + (r - wanted) * std::exp(-rest * kStep / time_constant);
      wanted = level(random);
      r = wanted + (r - wanted) * std::exp(-(1.0 - rest) * kStep / time_constant);
    } else {
      r = wanted + (r - wanted) * std::exp(-kStep / time_constant);
    }
    rate.t.push_back(kStep * k);
    rate.x.push_back({noise(random), noise(random), r + noise(random)});
  }
  return rate;
}

int count(const std::vector<std::uint8_t>& bad) { return std::accumulate(bad.begin(), bad.end(), 0); }

}  // namespace

TEST_CASE("spikes: a rate that steps or bends between slow samples is motion") {
  for (const double time_constant : {0.03, 0.1, 0.3}) {
    CAPTURE(time_constant);
    const Series rate = stepping(time_constant, 7);
    CHECK(count(estimation::speed_spikes(rate, kFloor)) == 0);
    if (time_constant < 0.2) CHECK(count(estimation::spikes(rate.t, rate.x, kFloor)) > 10);  // else nothing is shown
  }
}

TEST_CASE("spikes: one sample or two that leave and come back are found among such steps") {
  Series rate = stepping(0.1, 8);
  const std::vector<std::size_t> leaps{305, 1010, 1011, 2047};
  for (const std::size_t k : leaps) rate.x[k] += Eigen::Vector3d(0.0, 0.0, k == 2047 ? -3.0 : 3.0);
  const auto bad = estimation::speed_spikes(rate, kFloor);
  for (std::size_t k = 0; k < bad.size(); ++k) {
    CAPTURE(k);
    CHECK(bool(bad[k]) == (std::ranges::find(leaps, k) != leaps.end()));
  }
}

}  // namespace fathom

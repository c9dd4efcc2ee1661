// Long series become short without losing peaks; dependence and memory come out as computed by hand.
#include "common/report/series.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace fathom::report;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kExact = 1e-12;  // plain sums of small numbers
constexpr double kChance = 0.03;  // what 10 bins of 1000 independent samples may show by luck
constexpr std::size_t kSamples = 1000;

std::vector<double> count_up(std::size_t n) {
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = static_cast<double>(i);
  return x;
}

}  // namespace

TEST_CASE("Decimation keeps a single peak and a single dip") {
  std::vector<double> y(10000, 0.0);
  y[1234] = 5.0;
  y[8765] = -3.0;
  const Polyline line = decimate(count_up(y.size()), y, 400);
  CHECK(line.x.size() <= 420);
  CHECK(*std::ranges::max_element(line.y) == 5.0);
  CHECK(*std::ranges::min_element(line.y) == -3.0);
  CHECK(std::ranges::is_sorted(line.x));
}

TEST_CASE("A short series passes unchanged, parted at gaps and breaks") {
  const std::vector<double> y{1.0, 2.0, kNaN, 4.0, 5.0, 6.0};
  const std::vector<std::size_t> breaks{0, 5};
  const Polyline line = decimate(count_up(6), y, 100, breaks);
  REQUIRE(line.y.size() == 7);
  CHECK(line.y[1] == 2.0);
  CHECK(std::isnan(line.y[2]));
  CHECK(line.y[4] == 5.0);
  CHECK(std::isnan(line.y[5]));
  CHECK(line.x[6] == 5.0);
}

TEST_CASE("Bins hold medians and quartiles of equal shares") {
  const auto x = count_up(100);
  const auto bins = binned(x, x, 2);
  REQUIRE(bins.size() == 2);
  CHECK(bins[0].median == doctest::Approx(25.0).epsilon(0.05));  // between 24 and 25
  CHECK(bins[1].low < bins[1].median);
  CHECK(bins[1].median < bins[1].high);
  CHECK(binned(std::vector<double>{1.0, 2.0}, std::vector<double>{1.0, 2.0}, 10).empty());
}

TEST_CASE("Dependence is near one for a function, near zero for noise, absent for a constant") {
  std::mt19937 random{3};
  std::normal_distribution<double> normal;
  const auto x = count_up(kSamples);
  std::vector<double> curve(kSamples);
  std::vector<double> noise(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    curve[i] = std::pow(x[i] / 500.0 - 1.0, 2);
    noise[i] = normal(random);
  }
  CHECK(dependence(x, curve, 10, 1.0) > 0.9);
  CHECK(dependence(x, noise, 10, 1.0) < kChance);
  // With memory, the same curve rests on 50 independent samples, or on too few to say anything.
  CHECK(dependence(x, curve, 10, 0.05) < dependence(x, curve, 10, 1.0));
  CHECK(std::isnan(dependence(x, curve, 10, 0.005)));
  CHECK(std::isnan(dependence(std::vector<double>(kSamples, 2.0), noise, 10, 1.0)));
}

TEST_CASE("The autocorrelation of an alternating series alternates; records are not joined") {
  std::vector<double> alternating(100);
  for (std::size_t i = 0; i < alternating.size(); ++i) alternating[i] = i % 2 == 0 ? 1.0 : -1.0;
  const std::vector<std::vector<double>> records{alternating, alternating};
  const auto r = autocorrelation(records, 1, 3);
  CHECK(r[0] == doctest::Approx(1.0).epsilon(kExact));
  CHECK(r[1] == doctest::Approx(-1.0).epsilon(kExact));
  CHECK(r[2] == doctest::Approx(1.0).epsilon(kExact));
}

TEST_CASE("Quantiles ignore what is not a number") {
  const std::vector<double> values{kNaN, 3.0, 1.0, 2.0};
  CHECK(quantile(values, 0.0) == 1.0);
  CHECK(quantile(values, 0.5) == 2.0);
  CHECK(quantile(values, 1.0) == 3.0);
  CHECK(std::isnan(quantile(std::vector<double>{kNaN}, 0.5)));
}

// Bursts are found, and with what their size goes; noise of any distribution, with or without a memory, has none.
#include "common/diagnosis/bursts.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace fathom::diagnosis;

namespace {

constexpr std::size_t kCount = 640;
using Runs = std::vector<std::vector<double>>;

/// Noise of size 1, and of `size` in stretches of 4 samples in 20 whose beginning is drawn.
std::vector<double> noise_with_bursts(double size, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<std::size_t> begin{0, 16};
  std::vector<double> series(kCount);
  for (double& value : series) value = normal(random);
  for (std::size_t from = 0; from + 20 <= kCount; from += 20) {
    const std::size_t first = from + begin(random);
    for (std::size_t k = first; k < first + 4; ++k) series[k] *= size;
  }
  return series;
}

double heavy(std::mt19937& random) {  // Student's t of 3 degrees of freedom: outliers that nothing announces
  std::student_t_distribution<double> t{3.0};
  return t(random);
}

}  // namespace

TEST_CASE("bursts: what is large for a while and small for a while is found, in every draw") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Bursts found = bursts(Runs{noise_with_bursts(8.0, seed)});
    CHECK(found.log_odds > 5.0);
    CHECK(found.share > 0.6);
  }
}

TEST_CASE("bursts: independent noise has them as seldom as the odds say, outliers or not") {
  constexpr int kSeeds = 1000;
  int normal = 0, with_outliers = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    std::mt19937 random{seed};
    std::vector<double> tails(kCount);
    for (double& value : tails) value = heavy(random);
    normal += bursts(Runs{noise_with_bursts(1.0, seed)}).log_odds > 0.0 ? 1 : 0;
    with_outliers += bursts(Runs{tails}).log_odds > 0.0 ? 1 : 0;
  }
  // By the price of one number, half log n, chance outdoes it in 1.1 % of the draws (chi-square of 6.5 or more, of
  // which half are of the sign that counts: 0.55 %). 14 would be 3.6 standard deviations above 5.5.
  CHECK(normal <= 14);
  CHECK(with_outliers <= 14);
}

TEST_CASE("bursts: neighbours across a gap or in another run are none") {
  const std::vector<double> series = noise_with_bursts(8.0, 3);
  Runs apart;
  for (const double value : series) apart.push_back({value});
  CHECK(bursts(apart).log_odds < 0.0);
  std::vector<double> gaps;
  for (const double value : series) {
    gaps.push_back(value);
    gaps.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  CHECK(bursts(Runs{gaps}).log_odds < 0.0);
}

TEST_CASE("bursts: their size goes with what makes them, and with nothing else") {
  int right = 0, wrong = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    Runs left(1), thrust(1), other(1);
    double wanted = 0.0, wave = 0.0;
    const std::vector<double> at_times = noise_with_bursts(3.0, seed);
    for (std::size_t k = 0; k < kCount; ++k) {
      if (k % 8 == 0) wanted = std::abs(normal(random));
      wave = 0.9 * wave + normal(random);
      left[0].push_back(at_times[k] * (0.3 + wanted));
      thrust[0].push_back(wanted);
      other[0].push_back(wave);
    }
    right += size_goes_with(left, thrust) > 3.0 ? 1 : 0;
    wrong += size_goes_with(left, other) > 0.0 ? 1 : 0;
  }
  CHECK(right == 50);
  CHECK(wrong <= 2);  // two numbers priced log n: chance outdoes them once in 600
}

TEST_CASE("bursts: short, empty and constant series have none") {
  CHECK(bursts({}).log_odds < 0.0);
  CHECK(bursts(Runs{{1.0, 2.0, 3.0}}).log_odds < 0.0);
  CHECK(bursts(Runs{std::vector<double>(200, 0.0)}).log_odds < 0.0);
  CHECK(size_goes_with(Runs{noise_with_bursts(1.0, 1)}, Runs{std::vector<double>(kCount, 7.0)}) < 0.0);
}

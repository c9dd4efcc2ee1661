// Lines in spectra: found at their frequency, and hardly ever in noise with a memory.
#include "common/diagnosis/oscillation.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

using namespace fathom::diagnosis;

namespace {

std::vector<double> noise(std::size_t count, double phi, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  std::vector<double> series(count);
  double e = 0.0;
  for (double& value : series) value = e = phi * e + normal(random);
  return series;
}

}  // namespace

TEST_CASE("oscillation: a line in noise with a memory is found at its frequency") {
  for (const double frequency : {0.07, 0.21, 0.6}) {
    std::vector<double> series = noise(640, 0.7, 5);
    for (std::size_t k = 0; k < series.size(); ++k)
      series[k] += 1.5 * std::sin(2.0 * std::numbers::pi * frequency * 0.5 * static_cast<double>(k) + 0.3);
    const Line line = strongest_line(series, 0.5);
    CHECK(line.frequency == doctest::Approx(frequency).epsilon(0.03));
    CHECK(line.log_odds > 5.0);
    CHECK(line.share > 0.15);
  }
}

TEST_CASE("oscillation: noise has lines as seldom as the odds say") {
  constexpr int kSeeds = 400;
  int above = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed)
    above += strongest_line(noise(640, seed % 2 == 0 ? 0.8 : 0.0, seed), 0.5).log_odds > 3.0 ? 1 : 0;
  CHECK(above <= 30);  // 20 expected at e^-3 each; 30 is 2.3 standard deviations above
}

TEST_CASE("oscillation: short and empty series have none") {
  CHECK(strongest_line({}, 0.5).log_odds < 0.0);
  CHECK(strongest_line(noise(30, 0.0, 1), 0.5).log_odds < 0.0);
  CHECK(strongest_line(std::vector<double>(200, 0.0), 0.5).log_odds < 0.0);
}

#include "common/joint/innovation_colour.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

using fathom::joint::InnovationColour;

namespace {

/// Scores of standard deviation `size` whose neighbours are correlated by `memory`, over so many seconds.
double ratio_of(double size, double memory, int seconds, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  InnovationColour colour;
  double score = size * normal(random);
  for (int i = 0; i < 100 * seconds; ++i) {
    colour.hear(score);
    score = memory * score + std::sqrt(1.0 - memory * memory) * size * normal(random);
  }
  return colour.ratio();
}

double mean_of(double size, double memory, int seconds) {
  constexpr unsigned kSeeds = 40;
  double sum = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) sum += ratio_of(size, memory, seconds, seed);
  return sum / kSeeds;
}

}  // namespace

TEST_CASE("innovation colour: white noise gives its variance, be it as stated or not") {
  CHECK(InnovationColour{}.ratio() == 1.0);
  // A ratio of 40 sums varies by sqrt(2 / 40) times their share of two thirds, .15; the mean of 40 of them by .025.
  for (const double size : {1.0, 0.5, 2.0}) {
    CAPTURE(size);
    CHECK(mean_of(size, 0.0, 60) == doctest::Approx(size * size).epsilon(0.1));
    CHECK(mean_of(size, 0.0, 5) == doctest::Approx(size * size).epsilon(0.1));  // and that soon
  }
}

TEST_CASE("innovation colour: what lasts widens, the more the longer it was seen, and what alternates narrows") {
  // Sums of a second of an AR(1) have (1 + a) / (1 - a) times the variance of white ones, less what its ends lack.
  constexpr double kMemory = 0.9;
  const double whole = (1.0 + kMemory) / (1.0 - kMemory);
  const double soon = mean_of(1.0, kMemory, 5), late = mean_of(1.0, kMemory, 60);
  CHECK(soon > 2.0);
  CHECK(late > 1.5 * soon);
  CHECK(late == doctest::Approx((20.0 + 40.0 * whole) / 60.0).epsilon(0.15));
  CHECK(mean_of(1.0, -0.5, 60) == doctest::Approx((20.0 + 40.0 / 3.0) / 60.0).epsilon(0.15));
}

TEST_CASE("innovation colour: what was seen long ago is forgotten") {
  InnovationColour colour;
  for (int i = 0; i < 100 * 60; ++i) colour.hear(3.0);  // all of one sign
  CHECK(colour.ratio() > 100.0);
  for (int i = 0; i < 100 * 400; ++i) colour.hear(i % 2 == 0 ? 1.0 : -1.0);
  CHECK(colour.ratio() < 1.0);
}

TEST_CASE("innovation colour: refused innovations, and those of a dead instrument, make nothing certain") {
  std::mt19937 random{5};
  std::normal_distribution<double> normal;
  InnovationColour all, every_other, dead, quiet;
  for (int i = 0; i < 100 * 40; ++i) {
    const double score = normal(random);
    all.hear(score);
    every_other.hear(score);
    every_other.hear(0.0);
    dead.hear(0.0);
    quiet.hear(1e-6 * score);
  }
  CHECK(every_other.ratio() == all.ratio());
  CHECK(dead.ratio() == 1.0);
  CHECK(quiet.ratio() == 0.1);
}

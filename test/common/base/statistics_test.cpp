#include "common/base/statistics.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>

namespace fathom {

TEST_CASE("median and mad ignore a wild sample") {
  CHECK(median({3.0, 1.0, 2.0}) == 2.0);
  CHECK(median({4.0, 1.0, 2.0, 3.0}) == 2.5);
  CHECK(median({}) == 0.0);
  CHECK(mad_sigma({1.0, 2.0, 3.0, 4.0, 1e9}) == doctest::Approx(1.4826));
}

TEST_CASE("Huber's weight falls beyond its limit only") {
  CHECK(huber_weight(1.0) == 1.0);
  CHECK(huber_weight(-3.0, 1.5) == doctest::Approx(0.5));
}

TEST_CASE("white noise is measured on top of smooth motion") {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, 0.01);
  std::vector<double> series;
  series.reserve(5000);
  for (int i = 0; i < 5000; ++i) series.push_back(std::sin(0.05 * i) + normal(random));
  CHECK(white_noise_sigma(series) == doctest::Approx(0.01).epsilon(0.05));  // scatter of 5000 samples: 2 %
}

TEST_CASE("white noise is measured at unequal steps, of which plain differences make noise of the motion") {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, 0.001);
  std::uniform_real_distribution<double> step(0.01, 0.03);
  std::vector<double> t, series, before, after, steps;
  for (int i = 0; i < 5000; ++i) {
    t.push_back(i == 0 ? 0.0 : t.back() + step(random));
    series.push_back(std::sin(0.5 * t.back()) + normal(random));
    if (i == 0 || i == 2500) continue;  // a step is not known
    before.push_back(t[t.size() - 2]);
    after.push_back(t.back());
    steps.push_back(series.back() - series[series.size() - 2]);
  }
  CHECK(white_noise_sigma(series) > 0.0013);
  CHECK(white_noise_sigma(t, series) == doctest::Approx(0.001).epsilon(0.05));
  CHECK(white_noise_of_steps(before, after, steps) == doctest::Approx(0.001).epsilon(0.05));
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = 0.02 * static_cast<double>(i);
  CHECK(white_noise_sigma(t, series) == white_noise_sigma(series));
}

TEST_CASE("the jackknife of a mean is the standard error") {
  const std::array<double, 4> x{1.0, 2.0, 4.0, 7.0};
  std::array<double, 4> replicates{};
  for (std::size_t i = 0; i < 4; ++i) replicates[i] = (14.0 - x[i]) / 3.0;
  CHECK(jackknife_sigma(replicates) == doctest::Approx(std::sqrt(7.0 / 4.0)));  // variance 7
}

TEST_CASE("equal weights count all, one weight counts one") {
  CHECK(effective_count(std::array{2.0, 2.0, 2.0}) == doctest::Approx(3.0));
  CHECK(effective_count(std::array{0.0, 5.0, 0.0}) == doctest::Approx(1.0));
  CHECK(effective_count(std::array{3.0, 1.0}) == doctest::Approx(1.6));
  CHECK(effective_count(std::array{0.0, 0.0}) == 0.0);
}

TEST_CASE("pooling weighs by precision and admits scatter") {
  const std::array<double, 2> alike{1.0, 1.2};
  const std::array<double, 2> sigma{0.1, 0.2};
  CHECK(pool(alike, sigma).value == doctest::Approx(1.04));
  CHECK(pool(alike, sigma).sigma == doctest::Approx(std::sqrt(1.0 / 125.0)));
  const std::array<double, 2> apart{1.0, 3.0};
  const std::array<double, 2> small{0.1, 0.1};
  CHECK(pool(apart, small).sigma == doctest::Approx(1.0));
}

}  // namespace fathom

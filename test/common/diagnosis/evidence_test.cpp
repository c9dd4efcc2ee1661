// Evidence by hand, and on windows that carry nothing.
#include "common/diagnosis/evidence.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

using namespace fathom::diagnosis;

TEST_CASE("evidence: by hand") {
  // Falls 1 2 3: sum 6, mean 2, squared deviations 2, W = 4 * 36 / 2 = 72, ratio 1.5 ln(1 + 24).
  const std::vector<double> without{5, 6, 7}, with{4, 4, 4};
  CHECK(robust_log_likelihood_ratio(without, with) == doctest::Approx(1.5 * std::log(25.0)));
  CHECK(log_odds(without, with, 2, 10) == doctest::Approx(1.5 * std::log(25.0) - std::log(3.0) - std::log(10.0)));
}

TEST_CASE("evidence: never more than the costs say, nothing from a rise or from one window") {
  // Falls 1.0 1.1 0.9: hardly any spread, but three samples' worth of cost cannot give more than their sum.
  const std::vector<double> without{2.0, 2.1, 1.9}, with{1, 1, 1};
  CHECK(robust_log_likelihood_ratio(without, with) == doctest::Approx(3.0));
  CHECK(robust_log_likelihood_ratio(with, without) == 0.0);
  CHECK(robust_log_likelihood_ratio(std::vector{9.0}, std::vector{1.0}) == 0.0);
  CHECK(robust_log_likelihood_ratio(with, with) == 0.0);
}

TEST_CASE("evidence: one window that falls by a lot is worth less than many that fall a little") {
  std::vector<double> without(20, 10.0), one(20, 10.0), all(20, 9.0);
  one[3] = -10.0;  // the same sum
  all[0] = 9.1;
  CHECK(robust_log_likelihood_ratio(without, one) < 3.0);
  CHECK(robust_log_likelihood_ratio(without, all) > 15.0);
}

TEST_CASE("evidence: a useless parameter is seldom convincing, however long each window's memory") {
  // y = noise, constant within windows of `repeats` equal samples: naive counting would multiply the evidence.
  std::mt19937 random{1};
  std::normal_distribution<double> normal;
  int convinced = 0;
  constexpr int kTrials = 1000, kWindows = 30, kRepeats = 50;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> x(kWindows), y(kWindows);
    double xx = 0.0, xy = 0.0;
    for (std::size_t w = 0; w < kWindows; ++w) {
      x[w] = normal(random);
      y[w] = normal(random);
      xx += x[w] * x[w];
      xy += x[w] * y[w];
    }
    std::vector<double> without(kWindows), with(kWindows);
    for (std::size_t w = 0; w < kWindows; ++w) {
      without[w] = 0.5 * kRepeats * y[w] * y[w];
      with[w] = 0.5 * kRepeats * std::pow(y[w] - xy / xx * x[w], 2);
    }
    convinced += log_odds(without, with, 1, 1) > 3.0 ? 1 : 0;
  }
  CHECK(convinced < kTrials / 50);  // 20 to 1 and the price of a parameter
}

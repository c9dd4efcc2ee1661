// What was large once is found where it was; noise of any distribution has no such place, nor is one outlier one.
#include "common/diagnosis/episode.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace fathom::diagnosis;

namespace {

constexpr std::size_t kCount = 300;
using Runs = std::vector<std::vector<double>>;

std::vector<double> noise(unsigned seed, std::size_t count = kCount) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  std::vector<double> series(count);
  for (double& value : series) value = normal(random);
  return series;
}

}  // namespace

TEST_CASE("episode: what was large once, for a few samples, is found where it was, in every draw") {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Runs runs{noise(seed), noise(seed + 1000)};
    std::mt19937 random{seed};
    const std::size_t from = std::uniform_int_distribution<std::size_t>{20, 270}(random);
    for (std::size_t k = from; k < from + 8; ++k) runs[1][k] += k % 2 == 0 ? 12.0 : -9.0;
    const Episode found = episode(runs);
    CHECK(found.log_odds > 8.0);
    CHECK(found.run == 1);
    CHECK(found.first + 2 >= from);
    CHECK(found.first <= from + 2);
    CHECK(found.last + 2 >= from + 7);
    CHECK(found.last <= from + 9);
    CHECK(found.share > 0.4);
  }
}

TEST_CASE("episode: independent noise has one as seldom as the odds say, outliers or not") {
  constexpr int kSeeds = 2000;
  int normal = 0, with_outliers = 0, in_steps = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    std::mt19937 random{seed};
    std::student_t_distribution<double> t{2.0};  // of no variance at all
    std::vector<double> tails(kCount);
    for (double& value : tails) value = t(random);
    std::vector<double> rounded = noise(seed);
    for (double& value : rounded) value = std::round(value);
    in_steps += episode(Runs{rounded}).log_odds > 3.0 ? 1 : 0;
    normal += episode(Runs{noise(seed)}).log_odds > 3.0 ? 1 : 0;
    with_outliers += episode(Runs{tails}).log_odds > 3.0 ? 1 : 0;
  }
  // Every place, length and share has a chance of exp(-3) over their number, so all together have 5 % at the most.
  CHECK(normal <= 100);
  CHECK(with_outliers <= 100);
  CHECK(in_steps <= 100);
}

TEST_CASE("episode: one or two outliers, however large, are none; nor are neighbours across gaps") {
  std::vector<double> series = noise(5);
  series[100] = 1e6;
  series[101] = -1e6;
  CHECK(episode(Runs{series}).log_odds < 3.0);
  for (std::size_t k = 200; k < 220; k += 2) {
    series[k] = 50.0;
    series[k + 1] = std::numeric_limits<double>::quiet_NaN();
  }
  CHECK(episode(Runs{series}).log_odds < 3.0);
}

TEST_CASE("episode: too few samples, or nothing but zeros, tell nothing") {
  CHECK(episode(Runs{noise(1, 50)}).log_odds < 0.0);
  CHECK(episode(Runs{std::vector<double>(kCount, 0.0)}).log_odds < 0.0);
  CHECK(episode(Runs{}).log_odds < 0.0);
}

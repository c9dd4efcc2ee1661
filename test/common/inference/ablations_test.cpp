#include "common/inference/ablations.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "common/base/error.hpp"

using namespace fathom;
using namespace fathom::inference;

namespace {

/// All that an ablation may change.
std::vector<double> numbers_of(const Settings& settings) {
  const Thresholds& t = settings.thresholds;
  const likelihood::Terms& terms = settings.runs.terms;
  return {t.smallest_size,
          t.name_odds,
          t.free_force_odds,
          static_cast<double>(t.fits_per_round),
          static_cast<double>(t.pairs_per_round),
          static_cast<double>(t.few_effects),
          t.group_gain,
          t.group_price,
          t.searched_price,
          t.large_random,
          t.slow_memory,
          t.following,
          t.disagreement,
          terms.random_force ? 1.0 : 0.0,
          terms.coloured_noise ? 1.0 : 0.0,
          terms.tails ? 1.0 : 0.0,
          terms.followed_scale ? 1.0 : 0.0,
          terms.command_clock ? 1.0 : 0.0};
}

}  // namespace

TEST_CASE("ablations: each takes out something of its own, and an unknown one is told all names") {
  const Settings whole;
  std::vector<std::vector<double>> all{numbers_of(whole)};
  std::string message;
  try {
    Settings settings;
    ablate("luck", settings);
  } catch (const InputError& error) {
    message = error.what();
  }
  CHECK(message.starts_with("--ablate luck: "));
  for (const Ablation& one : ablations()) {
    CAPTURE(one.name);
    CHECK(message.find(one.name) != std::string::npos);
    Settings settings;
    ablate(one.name, settings);
    const std::vector<double> numbers = numbers_of(settings);
    for (const std::vector<double>& other : all) CHECK(numbers != other);
    all.push_back(numbers);
  }
}

// What lasts in a residual bounds what an effect could still explain, and is hardly anything where nothing is missing.
#include "common/diagnosis/left_to_explain.hpp"

#include <doctest/doctest.h>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using diagnosis::left_to_explain;
using identification::FitResult;
using identification::TrajectoryFit;

namespace {

constexpr double kDuration = 300.0;  // s
constexpr double kNothing = 0.01;    // of the cost: half a percent of the error, the least that counts
constexpr double kSlowShare = 0.6;   // of what these dives reveal: their sines have periods from 3 s on

test::VirtualDive dive_with(const model::Vehicle& vehicle, unsigned seed, std::vector<model::ActiveEffect> effects,
                            double noise_memory = 0.0) {
  return test::make_dive(vehicle, {.duration = kDuration,
                                   .dt = 0.04,
                                   .seed = seed,
                                   .noise_memory = noise_memory,
                                   .spread = 0.0,
                                   .effects = std::move(effects)});
}

}  // namespace

TEST_CASE("left to explain: nothing where nothing is missing, however strong the noise") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  for (const unsigned seed : {1U, 2U, 3U}) {
    CAPTURE(seed);
    const test::VirtualDive dive = dive_with(vehicle, seed, {});
    const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {}};
    CHECK(left_to_explain(problem, problem.fit(dive.truth)) < kNothing);
  }
}

TEST_CASE("left to explain: noise that lasts might be an effect") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive = dive_with(vehicle, 4, {}, 5.0);
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {}};
  CHECK(left_to_explain(problem, problem.fit(dive.truth)) > kNothing);
}

TEST_CASE("left to explain: no less than what a hidden effect of slow force explains") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const std::vector<model::ActiveEffect> hidden{
      test::active("current", {0.02, 0.01}), test::active("payload_change", {0.0, 0.4, 140.0}),
      test::active("compressibility", {0.1}), test::active("wave", {0.1, 0.1, 0.05, 0.05, 0.2}),
      test::active("asymmetric_drag", {1.0})};
  for (const model::ActiveEffect& effect : hidden) {
    CAPTURE(effect.effect->name());
    const test::VirtualDive dive = dive_with(vehicle, 5, {effect});
    const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {}};
    model::Model without = dive.truth;
    without.effects.clear();
    const FitResult base = problem.fit(without);
    const FitResult told = problem.fit(dive.truth, &base);
    const double explains = 1.0 - told.cost / base.cost;
    if (explains < kNothing) continue;
    CHECK(left_to_explain(problem, base) > kSlowShare * explains);
    CHECK(left_to_explain(problem, base) > kNothing);
  }
}

TEST_CASE("left to explain: nobody can tell from rare samples") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 60.0, .dt = 0.5, .seed = 6});
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {}};
  CHECK(left_to_explain(problem, problem.fit(dive.truth)) == 1.0);
}

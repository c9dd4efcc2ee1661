// The last test of what was accepted: two effects that imitate a third law give way to it, two true ones stay.
#include "common/diagnosis/pruning.hpp"

#include <doctest/doctest.h>

#include <random>
#include <string>
#include <vector>

#include "common/diagnosis/judgement.hpp"
#include "test/support/timing.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;
using identification::TrajectoryFit;

namespace {

constexpr int kFirstOrder = 0, kSecondOrder = 3;  // forms of thruster_lag
constexpr int kTried = 100;                       // candidates that share the prior, about as many as there are

/// A dive with these effects, and what a search has accepted on it.
struct Accepted {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  std::vector<Trial> trials;
  SearchResult found;

  Accepted(const std::vector<model::ActiveEffect>& truth, const std::vector<model::ActiveEffect>& accepted) {
    trials.push_back(
        test::make_dive(
            vehicle,
            {.duration = 120.0, .dt = 0.04, .seed = 6, .velocity_noise = 0.002, .rate_noise = 0.002, .effects = truth})
            .trial);
    const TrajectoryFit problem{vehicle, trials, {.window = 5.0}};
    found.before = problem.fit(model::nominal_model(vehicle, false));
    model::Model model = found.before.model;
    for (const model::ActiveEffect& each : accepted) {
      model.add(each);
      found.accepted.push_back({.effect = each.effect, .variant = each.variant, .variant_name = each.variant_name});
    }
    found.after = problem.fit(model, &found.before);
    prune(found, problem, model::scene_of(vehicle, trials), Settings{}, kTried, [](const std::string&, double) {});
  }
};

}  // namespace

TEST_CASE("pruning: a delay and a lag that imitate one lag of second order give way to it") {
  if (!test::kTimed) return;
  std::mt19937 random{20261124};
  const double time_constant = std::uniform_real_distribution<double>{0.08, 0.12}(random);  // s
  CAPTURE(time_constant);
  const Accepted dive{{test::active("thruster_lag", {time_constant, 0.0}, kSecondOrder)},
                      {test::active("thruster_delay", {0.07}), test::active("thruster_lag", {0.12, 0.0}, kFirstOrder)}};
  REQUIRE(dive.found.accepted.size() == 1);
  CHECK(dive.found.accepted[0].effect->name() == "thruster_lag");
  CHECK(dive.found.accepted[0].variant == kSecondOrder);
  REQUIRE(dive.found.refused.size() == 1);
  CHECK(dive.found.refused[0].effect->name() == "thruster_delay");
  CHECK(dive.found.refused[0].reason == "made superfluous by another form of thruster_lag");
  REQUIRE(dive.found.after.model.effects.size() == 1);
  CHECK(dive.found.after.model.effects[0].theta[0] == doctest::Approx(time_constant).epsilon(0.1));
}

TEST_CASE("pruning: a true delay and a true lag stay both") {
  if (!test::kTimed) return;
  const Accepted dive{{test::active("thruster_delay", {0.15}), test::active("thruster_lag", {0.3, 0.0}, kFirstOrder)},
                      {test::active("thruster_delay", {0.1}), test::active("thruster_lag", {0.2, 0.0}, kFirstOrder)}};
  CHECK(dive.found.refused.empty());
  REQUIRE(dive.found.accepted.size() == 2);
  CHECK(dive.found.accepted[0].effect->name() == "thruster_delay");
  CHECK(dive.found.accepted[1].variant == kFirstOrder);
}

TEST_CASE("pruning: a delay is told only where it is longer than how commands are held could make it") {
  if (!test::kTimed) return;
  const auto with_delay = [](double delay) {
    return Accepted{{test::active("thruster_delay", {delay})}, {test::active("thruster_delay", {delay})}};
  };
  const Accepted brief = with_delay(0.012), long_enough = with_delay(0.06);  // s; commands are 0.04 s apart
  CHECK(brief.found.accepted.empty());
  REQUIRE(brief.found.refused.size() == 1);
  CHECK(brief.found.refused[0].reason == std::string{kTooQuick});
  CHECK(brief.found.refused[0].log_odds > Settings{}.accept_log_odds);  // or it would have been refused anyway
  CHECK(long_enough.found.accepted.size() == 1);
}

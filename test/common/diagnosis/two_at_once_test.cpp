// Two effects of which each drowns the other are found together, beside what a wrong winner explains; one effect alone,
// or none, makes no two.
#include "common/diagnosis/two_at_once.hpp"

#include <doctest/doctest.h>

#include <random>

#include "common/identification/fit_from_priors.hpp"
#include "common/identification/sparse.hpp"
#include "test/common/diagnosis/search_dives.hpp"

namespace fathom::diagnosis {
namespace {

/// The first looks at a dive, and two that are found at once in them.
std::optional<Two> two_in(const model::Vehicle& vehicle, const std::vector<model::ActiveEffect>& effects,
                          unsigned seed) {
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 150.0, .dt = 0.04, .seed = seed, .effects = effects});
  const std::vector<Trial> trials{dive.trial};
  const Settings settings;
  const identification::TrajectoryFit problem{vehicle, trials, settings.fit};
  const identification::FitResult base =
      problem.fit(identification::fit_from_priors(vehicle, trials, settings.fit).model);
  NearView near{vehicle, trials, settings};
  near.fit(base.model);
  const model::Scene scene = model::scene_of(vehicle, trials);
  const std::vector<Candidate> candidates = all_candidates(scene);
  const Answers answers = ask_near(candidates, near, scene, settings);
  const Progress silent = [](const std::string&, double) {};
  return find_two(
      {candidates, near, problem, base, trials, scene, settings, static_cast<int>(candidates.size()), silent, 0.0},
      answers, worthy_pairs(answers), base);
}

std::string names_of(const std::optional<Two>& two) {
  if (!two) return "";
  std::vector<std::string> names{std::string{two->judged[0].effect->name()},
                                 std::string{two->judged[1].effect->name()}};
  std::ranges::sort(names);
  return names[0] + " " + names[1];
}

}  // namespace

TEST_CASE("two at once: buoyancy that goes with depth and drag that differs up and down") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const auto names = model::find_effect("asymmetric_drag")->variants(model::Scene{.vehicle = &vehicle});
  const auto form = static_cast<int>(std::ranges::find(names, "Z_|w| Z_ww") - names.begin());
  std::mt19937 random{20261126};
  std::uniform_real_distribution<double> factor{0.8, 1.2};
  for (unsigned seed = 1; seed <= (test::kTimed ? 3U : 1U); ++seed) {
    CAPTURE(seed);
    const double k = -3.0 * factor(random), linear = -2.0 * factor(random), square = -6.0 * factor(random);
    const std::optional<Two> two = two_in(
        vehicle, {test::active("compressibility", {k}), test::active("asymmetric_drag", {square, linear}, form)}, seed);
    CHECK(names_of(two) == "asymmetric_drag compressibility");
    if (!two) continue;
    for (const Judged& judged : two->judged) {
      CHECK(judged.reason.empty());
      CHECK(judged.log_odds > 5.0);
    }
    for (const model::ActiveEffect& active : two->fit.model.effects) {
      if (active.effect->name() == "compressibility") CHECK(active.theta[0] == doctest::Approx(k).epsilon(0.1));
    }
  }
}

TEST_CASE("two at once: one effect alone is none, and neither is noise") {
  if (!test::kTimed) return;
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  for (unsigned seed = 11; seed <= 13; ++seed) {
    CAPTURE(seed);
    CHECK(names_of(two_in(vehicle, {}, seed)).empty());
    CHECK(names_of(two_in(vehicle, {test::active("compressibility", {6.0})}, seed)).empty());
    CHECK(names_of(two_in(vehicle, {test::active("thruster_lag", {0.2})}, seed)).empty());
  }
}

TEST_CASE("two at once: a failure and a payload that act on one axis are each found at their own moment") {
  if (!test::kTimed) return;
  const model::Vehicle& vehicle = vehicle_named("seabotix_lbv150");
  std::mt19937 random{20261127};
  std::uniform_real_distribution<double> factor{0.9, 1.1};
  for (unsigned seed = 21; seed <= 22; ++seed) {
    const double weight = -4.0 * factor(random), dropped = 70.0 * factor(random), fails = 150.0 * factor(random);
    CAPTURE(seed);
    const auto failure =
        draw({"thruster_failure", "vertical", {{0.45, 0.55}, {fails, fails + 1e-6}}}, vehicle, 60.0, seed);
    REQUIRE(failure.has_value());
    const Outcome outcome = search_dive(
        vehicle, {*failure, test::active("payload_change", {-0.6 * factor(random), weight, dropped})}, 220.0, seed);
    CAPTURE(outcome.said);
    REQUIRE(outcome.found.accepted.size() == 2);
    for (const model::ActiveEffect& active : outcome.found.after.model.effects) {
      const bool payload = active.effect->name() == "payload_change";
      CHECK((payload || active.effect->name() == "thruster_failure"));
      CHECK(active.theta.back() == doctest::Approx(payload ? dropped : fails).epsilon(0.01));
    }
  }
}

}  // namespace fathom::diagnosis

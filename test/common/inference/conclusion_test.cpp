// The verdict's rules, each by what it is for: a model that does not follow, a name taken out of the list, an effect
// too small to matter.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/inference/infer.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::inference;

namespace {

/// What a search that found nothing leaves, at the vehicle file's numbers and the noise's priors.
struct Nothing {
  explicit Nothing(double duration = 30.0)
      : dive{test::fly(vehicle, {.duration = duration, .force = 0.05})},
        problem{likelihood::make_problem(vehicle, {&dive.trial, 1})} {
    likelihood::Fit& fit = conclusion.found.best.fit;
    fit.hypothesis = likelihood::nominal_hypothesis(problem);
    fit.noise = likelihood::prior_noise(problem);
    fit.numbers = problem.numbers(fit.hypothesis);
    fit.information = 1e4 * Eigen::MatrixXd::Identity(static_cast<Eigen::Index>(fit.numbers.size()),
                                                      static_cast<Eigen::Index>(fit.numbers.size()));
    fit.finite = true;
    conclusion.reported = fit;
  }
  Conclusion concluded() {
    conclude(problem, {}, conclusion);
    return conclusion;
  }

  model::Vehicle vehicle{test::vehicle_from_repository("bluerov2")};
  test::VirtualDive dive;
  likelihood::Problem problem;
  Conclusion conclusion;
};

bool caused(const Conclusion& conclusion, Cause cause, const std::string& of) {
  return std::ranges::any_of(conclusion.reasons,
                             [&](const Reason& reason) { return reason.cause == cause && reason.of == of; });
}

const Refused* refused(const Found& found, const std::string& name) {
  const auto place = std::ranges::find(found.refused, name, &Refused::name);
  return place != found.refused.end() ? &*place : nullptr;
}

Conclusion inferred(const test::NoisyDive& settings, const std::vector<std::string>& without = {}) {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, settings);
  return infer(vehicle, {&dive.trial, 1}, {.without = without}, {});
}

}  // namespace

TEST_CASE("conclusion: nothing found, all in order: adequate") {
  CHECK(Nothing{}.concluded().verdict == Verdict::adequate);
}

TEST_CASE("conclusion: an axis whose acceleration is a random force's leaves no model") {
  Nothing nothing;
  nothing.conclusion.followed = {0.9, -0.1, 0.9, 0.9};
  const Conclusion conclusion = nothing.concluded();
  CHECK(conclusion.verdict == Verdict::no_model);
  CHECK(caused(conclusion, Cause::kNotFollowing, "Y"));
  CHECK_FALSE(caused(conclusion, Cause::kNotFollowing, "X"));
}

TEST_CASE("conclusion: an axis that nothing pushes has no thrust that it could fail to follow") {
  Nothing nothing;
  nothing.conclusion.followed = {0.9, -0.1, 0.9, 0.9};
  nothing.vehicle.allocation.row(1).setZero();  // a boat's sway
  const Conclusion conclusion = nothing.concluded();
  CHECK(conclusion.verdict == Verdict::adequate);
  CHECK_FALSE(caused(conclusion, Cause::kNotFollowing, "Y"));
}

TEST_CASE("conclusion: an inertia of a motion that is not simulated may stop on its bound") {
  Nothing nothing;  // pitch enters as measured
  likelihood::Fit& fit = nothing.conclusion.found.best.fit;
  const auto number = std::ranges::find(fit.numbers, "m_X", &likelihood::Number::name);
  REQUIRE(number != fit.numbers.end());
  at(fit.hypothesis, *number) = number->low;
  number->name = "I_Y";  // it acts through (I_X - I_Y) p q alone
  const Conclusion conclusion = nothing.concluded();
  CHECK(conclusion.verdict == Verdict::adequate);
  CHECK_FALSE(caused(conclusion, Cause::kAbsurdNumber, "I_Y"));
}

TEST_CASE("conclusion: a number that no vehicle has, or one on its bound, leaves no model") {
  for (const double mass : {2000.0, 0.0}) {
    Nothing nothing;
    likelihood::Fit& fit = nothing.conclusion.found.best.fit;
    const auto number = std::ranges::find(fit.numbers, "m_X", &likelihood::Number::name);
    REQUIRE(number != fit.numbers.end());
    at(fit.hypothesis, *number) = std::max(mass, number->low);
    const Conclusion conclusion = nothing.concluded();
    CHECK(conclusion.verdict == Verdict::no_model);
    CHECK(caused(conclusion, Cause::kAbsurdNumber, "m_X"));
  }
}

TEST_CASE("conclusion: as many names as the search allows are no claim, nor a few where more did not do") {
  Nothing nothing;
  const auto hold = [&](std::initializer_list<const char*> names) {
    Found& found = nothing.conclusion.found;
    found.best.names = {names.begin(), names.end()};
    found.best.fit.hypothesis.model.effects.clear();
    for (const char* name : names)
      found.best.fit.hypothesis.model.effects.push_back({.effect = model::find_effect(name), .variant_name = ""});
    found.probability = found.reliability = std::vector<double>(names.size(), 1.0);
    found.rival.assign(names.size(), "");
    nothing.conclusion.reasons.clear();
    return nothing.concluded();
  };
  const Conclusion conclusion = hold({"current", "cubic_drag", "thruster_lag", "wave", "payload_change",
                                      "tether_tension", "wall_effect", "thruster_gain"});
  CHECK(conclusion.verdict == Verdict::unexplained);
  CHECK(caused(conclusion, Cause::kManyNames, ""));
  CHECK(hold({"current", "cubic_drag", "thruster_lag", "wave", "payload_change"}).verdict == Verdict::effect);
  nothing.conclusion.found.wanted = 6;
  const Conclusion few = hold({"current", "cubic_drag", "thruster_lag", "wave"});
  CHECK(few.verdict == Verdict::unexplained);
  CHECK(caused(few, Cause::kManyNames, ""));
  nothing.conclusion.found.wanted = 0;
  nothing.conclusion.found.cut_short = true;
  CHECK(hold({"current", "cubic_drag", "thruster_lag", "wave"}).verdict == Verdict::unexplained);
  nothing.conclusion.found.cut_short = false;
  CHECK(hold({"current", "cubic_drag", "thruster_lag", "wave"}).verdict == Verdict::effect);
  // What a hull does in oblique flow by its nature is none of them, and need not be sure beside them.
  CHECK(hold({"body_lift", "cross_flow", "cubic_drag", "thruster_lag", "wave"}).verdict == Verdict::effect);
  static_cast<void>(hold({"body_lift", "current"}));
  nothing.conclusion.found.reliability = {0.7, 1.0};
  nothing.conclusion.reasons.clear();
  CHECK(nothing.concluded().verdict == Verdict::effect);
  static_cast<void>(hold({"body_lift"}));
  nothing.conclusion.found.reliability = {0.7};
  nothing.conclusion.reasons.clear();
  CHECK(nothing.concluded().verdict == Verdict::effect);
  // Another name fits as well: a term of the same flow says nothing else, one of what is missing does.
  nothing.conclusion.found.probability = {0.7};
  nothing.conclusion.found.rival = {"turning_resistance"};
  nothing.conclusion.reasons.clear();
  CHECK(nothing.concluded().verdict == Verdict::effect);
  nothing.conclusion.found.rival = {"cross_coupling"};
  nothing.conclusion.reasons.clear();
  CHECK(nothing.concluded().verdict == Verdict::ambiguous);
}

TEST_CASE("conclusion: a free force that there was no time to fit is a cause, and what it promises no number") {
  Nothing nothing;
  auto& force = nothing.conclusion.found.free_force.emplace();
  force.log_odds = 2e6;
  force.size.share = 0.02;
  const Conclusion promised = nothing.concluded();
  CHECK(promised.verdict == Verdict::unexplained);
  REQUIRE(promised.reasons.size() == 1);
  CHECK(promised.reasons.front().cause == Cause::kFreeForce);
  CHECK(std::isnan(promised.reasons.front().value));
  force.log_odds = 20.0;
  force.fit.finite = true;
  nothing.conclusion.reasons.clear();
  CHECK(nothing.concluded().reasons.front().value == 20.0);
}

TEST_CASE("conclusion: a name of little evidence is no claim, however far behind the others are") {
  const Thresholds thresholds;
  CHECK(thresholds.reliability(thresholds.even_evidence) == doctest::Approx(0.5));
  CHECK(thresholds.reliability(-5.0) == 0.0);
  Nothing nothing;
  nothing.conclusion.found.best.names = {"a"};
  nothing.conclusion.found.probability = {1.0};
  nothing.conclusion.found.reliability = {thresholds.reliability(2.0 * thresholds.name_odds)};
  const Conclusion weak = nothing.concluded();
  CHECK(weak.verdict == Verdict::ambiguous);
  CHECK(caused(weak, Cause::kWeakEvidence, ""));
  nothing.conclusion.reasons.clear();
  nothing.conclusion.found.reliability = {thresholds.reliability(1000.0)};
  CHECK(nothing.concluded().verdict == Verdict::effect);
  nothing.conclusion.reasons.clear();
  nothing.conclusion.found.probability = {0.6};
  const Conclusion rivals = nothing.concluded();
  CHECK(rivals.verdict == Verdict::ambiguous);
  CHECK(caused(rivals, Cause::kRivals, ""));
}

TEST_CASE("conclusion: both scores' numbers apart are told, and change no verdict") {
  Nothing nothing;
  nothing.conclusion.disagreement = 0.1;
  const Conclusion conclusion = nothing.concluded();
  CHECK(conclusion.verdict == Verdict::adequate);
  CHECK(caused(conclusion, Cause::kScoresDisagree, ""));
}

TEST_CASE("infer: a search that was cut short judges nothing, and says after how long") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 60.0, .force = 0.02});
  constexpr double kBudget = 1e-6;  // s, over before the first fit is
  const Conclusion conclusion = infer(vehicle, {&dive.trial, 1}, {.time_budget = kBudget}, {});
  CHECK(conclusion.verdict == Verdict::not_judged);
  REQUIRE(caused(conclusion, Cause::kOutOfTime, ""));
  const auto why = std::ranges::find(conclusion.reasons, Cause::kOutOfTime, &Reason::cause);
  CHECK(why->threshold == kBudget);
  CHECK(why->value > kBudget);
}

TEST_CASE("infer: thrusters that push the other way leave no model") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  auto dive = test::fly(vehicle, {.duration = 60.0, .force = 0.02});
  for (Eigen::VectorXd& input : dive.trial.input) input = -input;
  CHECK(infer(vehicle, {&dive.trial, 1}, {}, {}).verdict == Verdict::no_model);
}

TEST_CASE("infer: an effect taken out of the list is not named, and what it does is unexplained") {
  const test::NoisyDive settings{
      .duration = 90.0, .seed = 4, .force = 0.05, .effects = {test::active("current", {0.1, 0.05})}};
  const Conclusion conclusion = inferred(settings, {"current"});
  CHECK(conclusion.verdict == Verdict::unexplained);
  CHECK(std::ranges::find(conclusion.found.best.names, "current") == conclusion.found.best.names.end());
  CHECK(refused(conclusion.found, "current") == nullptr);
}

TEST_CASE("infer: an effect that is there and too small to matter is refused by its size") {
  const Conclusion conclusion = inferred({.duration = 90.0,
                                          .seed = 4,
                                          .force = 0.002,
                                          .sensor = 0.0005,
                                          .effects = {test::active("current", {0.0015, 0.0})}});
  CHECK(conclusion.found.best.names.empty());
  const Refused* current = refused(conclusion.found, "current");
  REQUIRE(current != nullptr);
  REQUIRE(current->refusals.size() == 1);
  CHECK(current->refusals[0].rule == Rule::kSize);
  CHECK(current->refusals[0].value < current->refusals[0].needed);
}

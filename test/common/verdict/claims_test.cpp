// What is listed as a cause, and what is not.
#include <doctest/doctest.h>

#include <algorithm>

#include "common/verdict/by_likelihood.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;

namespace {

verdict::Answer answer_to(const test::NoisyDive& settings, const std::vector<std::string>& without) {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto train = test::fly(vehicle, settings);
  test::NoisyDive other = settings;
  other.seed += 1;
  const auto validate = test::fly(vehicle, other);
  return verdict::diagnose(vehicle, {&train.trial, 1}, {&validate.trial, 1}, {.without = without}, {},
                           {.learn = false});
}

}  // namespace

TEST_CASE("claims: beside something that no list holds nothing is a cause, and the model is not worse") {
  const test::NoisyDive settings{
      .duration = 90.0, .seed = 4, .force = 0.05, .effects = {test::active("current", {0.1, 0.05})}};
  const verdict::Answer answer = answer_to(settings, {"current"});
  const DiagnosisResult& result = answer.report.result;
  CHECK(result.verdict == "unexplained");
  CHECK(result.effects.empty());
  CHECK(std::ranges::none_of(answer.given.causes, [](const CauseGiven& cause) { return cause.cause == "named"; }));
  CHECK_FALSE(result.improvement.high < 0.0);
  for (const StandIn& one : result.stand_ins) {
    const auto tried = std::ranges::find(result.candidates, one.name, &CandidateTried::name);
    REQUIRE(tried != result.candidates.end());
    CHECK(tried->reason == "stand-in");
    if (one.in_model) CHECK(result.improvement.low > 0.0);
  }
}

TEST_CASE("claims: a listed effect is a cause, and no stand-in") {
  const verdict::Answer answer =
      answer_to({.duration = 90.0, .seed = 4, .force = 0.05, .effects = {test::active("current", {0.1, 0.05})}}, {});
  const DiagnosisResult& result = answer.report.result;
  CHECK(result.verdict == "effect");
  REQUIRE(result.effects.size() == 1);
  CHECK(result.effects[0].name == "current");
  CHECK(result.stand_ins.empty());
  // Every listed effect has an answer: found, refused, or why it was not asked.
  for (const model::Effect* effect : model::all_effects()) {
    CAPTURE(effect->name());
    const auto answered = std::ranges::find(result.candidates, effect->name(), &CandidateTried::name);
    REQUIRE(answered != result.candidates.end());
    CHECK_FALSE(answered->reason.empty());
  }
  REQUIRE(!result.effects[0].parameters.empty());
  CHECK(result.effects[0].parameters[0].value == doctest::Approx(0.1).epsilon(0.1));  // m/s toward north
}

TEST_CASE("claims: the surest cause is told first, in whatever order causes act") {
  const verdict::Answer answer =
      answer_to({.duration = 90.0,
                 .seed = 4,
                 .force = 0.05,
                 .effects = {test::active("thruster_lag", {0.06}), test::active("current", {0.2, 0.1})}},
                {});
  const std::vector<EffectFound>& effects = answer.report.result.effects;
  REQUIRE(effects.size() == 2);
  CHECK(effects[0].name == "current");
  CHECK(effects[1].name == "thruster_lag");
  CHECK(effects[0].log_odds > effects[1].log_odds);
  const std::string& told = answer.report.result.paragraph;
  CHECK(told.find("current") < told.find("thruster lag"));
}

TEST_CASE("claims: what foretells the runs that judge worse than the model without it is no cause") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = [&](double north, unsigned seed) {
    return test::fly(
        vehicle,
        {.duration = 90.0, .seed = seed, .force = 0.05, .effects = {test::active("current", {north, 0.5 * north})}});
  };
  const auto train = dive(0.1, 4), judge = dive(-0.1, 5);  // the tide has turned
  const verdict::Answer answer =
      verdict::diagnose(vehicle, {&train.trial, 1}, {&judge.trial, 1}, {}, {}, {.learn = false});
  const DiagnosisResult& result = answer.report.result;
  CHECK(result.verdict == "unexplained");
  CHECK(result.effects.empty());
  CHECK(std::ranges::any_of(answer.given.causes, [](const CauseGiven& one) { return one.cause == "names_mislead"; }));
  CHECK_FALSE(result.improvement.high < 0.0);
  REQUIRE_FALSE(result.stand_ins.empty());
  CHECK(result.stand_ins[0].name == "current");
  CHECK_FALSE(result.stand_ins[0].in_model);
}

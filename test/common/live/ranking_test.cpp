// An answer as EFFECTS says it: what is a candidate, what is none, and with which numbers.
#include "common/live/ranking.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "test/support/virtual_dive.hpp"

namespace fathom::live {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

verdict::Answer answer_with(const std::string& verdict) {
  verdict::Answer answer;
  answer.report.result.verdict = verdict;
  answer.report.result.improvement = {kNone, kNone, kNone};
  return answer;
}

}  // namespace

TEST_CASE("ranking: an accepted effect comes first with the model's own numbers, then what was refused, by its odds") {
  verdict::Answer answer = answer_with("effect");
  DiagnosisResult& result = answer.report.result;
  answer.best.hypothesis.model.effects = {test::active("current", {0.1, -0.2})};
  result.effects.push_back({.name = "current", .parameters = {{"v_N", 9.0, 0.1, "m/s"}}, .log_odds = 50.0});
  result.improvement = {0.8, 0.7, 0.9};
  result.candidates = {{.name = "current", .log_odds = 50.0, .reason = "accepted"},
                       {.name = "thruster_lag", .log_odds = -3.0, .reason = "odds"},
                       {.name = "payload_change", .log_odds = 4.0, .reason = "odds"},
                       {.name = "wave", .log_odds = kNone, .reason = "score"}};
  const EffectRanking ranking = ranking_of(answer);
  CHECK(ranking.verdict == "effect");
  REQUIRE(ranking.candidates.size() == 3);
  CHECK(ranking.candidates[0].name == "current");
  CHECK(ranking.candidates[0].numbers == test::active("current", {0.1, -0.2}).theta);
  CHECK(ranking.candidates[0].log_odds == 50.0);
  CHECK(ranking.candidates[0].error_reduction == 0.8);
  CHECK(ranking.candidates[1].name == "payload_change");
  CHECK(ranking.candidates[2].name == "thruster_lag");
  CHECK(ranking.against.empty());
}

TEST_CASE("ranking: what stands in for something unlisted is no candidate, and no number is none") {
  verdict::Answer answer = answer_with("unexplained");
  DiagnosisResult& result = answer.report.result;
  result.stand_ins.push_back({.name = "current", .in_model = true, .size = 0.2});
  result.candidates = {{.name = "current", .log_odds = 90.0, .reason = "stand-in"},
                       {.name = "wall_effect", .variant = "force", .log_odds = 2.0, .reason = "odds"}};
  const EffectRanking ranking = ranking_of(answer);
  CHECK(ranking.verdict == "unexplained");
  REQUIRE(ranking.candidates.size() == 1);
  CHECK(ranking.candidates[0].name == "wall_effect");
  CHECK(ranking.candidates[0].variant == "force");
  CHECK(ranking.candidates[0].error_reduction == 0.0);
}

TEST_CASE("ranking: a sensor's fault keeps the numbers that it was found with, and no segment is asked about it") {
  verdict::Answer answer = answer_with("ambiguous");
  answer.report.result.effects.push_back(
      {.name = "sensor_latency", .variant = "dvl", .parameters = {{"dvl.delay", 0.2, 0.01, "s"}}, .log_odds = 30.0});
  answer.rivals.emplace(test::active("sensor_latency", {0.2}), test::active("current", {0.1, 0.0}));
  const EffectRanking ranking = ranking_of(answer);
  CHECK(ranking.candidates.at(0).numbers == std::vector{0.2});
  CHECK(ranking.against == "current");
  CHECK_FALSE(rivals_of(answer));
  answer.rivals.emplace(test::active("current", {0.1, 0.0}), test::active("thruster_lag", {0.3}));
  REQUIRE(rivals_of(answer));
  CHECK(rivals_of(answer)->second.effect->name() == "thruster_lag");
}

TEST_CASE("ranking: what was learned at the end is told with its law, or with why it is not") {
  verdict::Answer answer = answer_with("unexplained");
  CHECK_FALSE(learned_of(answer).has_value());
  CorrectionGiven& given = answer.report.result.correction.emplace();
  CHECK_FALSE(learned_of(answer).has_value());  // nothing was asked
  given.asked = true;
  given.log_odds = 12.0;
  given.size = 0.08;
  given.refused = "log odds 12, at least 20 needed";
  given.words = "A force.";
  std::optional<LearnedTold> learned = learned_of(answer);
  REQUIRE(learned.has_value());
  CHECK_FALSE(learned->adopted);
  CHECK(learned->words == "log odds 12, at least 20 needed");
  CHECK(learned->log_odds == 12.0);
  given.adopted = true;
  given.held_out = 0.4;
  given.formula = FormulaGiven{.equation = "tau_Y = c u v", .numbers = {{"c", 3.0, 0.1, "SI"}}};
  learned = learned_of(answer);
  REQUIRE(learned.has_value());
  CHECK(learned->adopted);
  CHECK(learned->words == "A force.");
  CHECK(learned->held_out == 0.4);
  CHECK(learned->equation == "tau_Y = c u v");
  REQUIRE(learned->numbers.size() == 1);
  CHECK(learned->numbers[0].value == 3.0);
}

}  // namespace fathom::live

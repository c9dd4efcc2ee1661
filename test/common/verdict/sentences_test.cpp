// Words of a refusal: what was reached and what was needed.
#include <doctest/doctest.h>

#include <limits>

#include "common/verdict/by_likelihood.hpp"

using namespace fathom;
using inference::Rule;

TEST_CASE("sentences: a refusal says what was reached and what was needed") {
  CHECK(verdict::sentence({Rule::kOdds, 3.21, 10.0}) == "log odds 3.2, 10 needed");
  CHECK(verdict::sentence({Rule::kOdds, -std::numeric_limits<double>::infinity(), 10.0}) ==
        "no fit with it came to an end");
  CHECK(verdict::sentence({Rule::kSize, 0.0043, 0.01}) == "0.43 % of the applied force, 1 % needed");
  CHECK(verdict::sentence({Rule::kProbability, 0.4, 0.9}) == "probability 0.4 beside other names, 0.9 needed");
  CHECK(verdict::sentence({Rule::kScore, 1.04, 8.0}) == "promises 1.0 nats, 8 needed to be fitted");
  CHECK(verdict::sentence({Rule::kScore, 52.0, 8.0}) == "promises 52.0 nats, others more");
  CHECK(verdict::sentence({Rule::kBound, 12.0, 10.0}) == "fits only with a number at its limit");
}

TEST_CASE("sentences: a named effect's look-alike is told beside it, with what tells the two apart") {
  inference::Conclusion conclusion;
  conclusion.verdict = inference::Verdict::effect;
  CHECK(verdict::paragraph(conclusion).find("as well") == std::string::npos);
  conclusion.look_alikes.push_back({"bottom_effect", "denser water below the depths visited", "going deeper"});
  const std::string told = verdict::paragraph(conclusion);
  CHECK(told.find("may be denser water below the depths visited as well, of which these data say nothing: ") !=
        std::string::npos);
  CHECK(told.find("what tells is going deeper. ") != std::string::npos);
  conclusion.verdict = inference::Verdict::adequate;
  CHECK(verdict::paragraph(conclusion).find("denser") == std::string::npos);
}

TEST_CASE("sentences: where one of several names is doubtful, those that are sure are told as found") {
  inference::Conclusion conclusion;
  conclusion.verdict = inference::Verdict::ambiguous;
  conclusion.reasons = {{inference::Cause::kWeakEvidence, 0.7, 0.9, ""}};
  auto& found = conclusion.found;
  for (const char* name : {"current", "wave"})
    found.best.fit.hypothesis.model.effects.push_back({.effect = model::find_effect(name), .variant_name = ""});
  found.odds = {500.0, 9.0};
  found.size = {0.2, 0.1};
  found.probability = {1.0, 1.0};
  found.reliability = {0.95, 0.7};
  found.rival = {"", ""};
  const std::string told = verdict::paragraph(conclusion);
  CHECK(
      told.starts_with("Found: current: 20 % of the applied force, log odds 500. More is missing, and the evidence for "
                       "a name is weak. Likeliest: wave: 10 % of the applied force, log odds 9. "));
  found.reliability = {0.7, 0.7};
  CHECK(verdict::paragraph(conclusion)
            .starts_with("Something is missing, and the evidence for a name is weak. Likeliest: current: 20 %"));
}

TEST_CASE("sentences: a free force that was not fitted has no odds") {
  inference::Conclusion conclusion;
  conclusion.verdict = inference::Verdict::unexplained;
  conclusion.found.free_force.emplace().size = {.share = 0.02, .axis = 0};
  conclusion.reasons = {{inference::Cause::kFreeForce, std::numeric_limits<double>::quiet_NaN(), 5.0, "depth in X"}};
  CHECK(verdict::paragraph(conclusion)
            .starts_with(
                "Something acts that no listed effect explains: 2.0 % of the applied force in X, by a first look "
                "that there was no time to confirm. It goes with depth in X. "));
  conclusion.reasons.front().value = 41.0;
  CHECK(verdict::paragraph(conclusion).find("in X, log odds 41. It goes with depth in X. ") != std::string::npos);
}

TEST_CASE("sentences: what swings is told with its period, what only remembers itself is not") {
  std::vector<AxisWhiteness> left{{.axis = "X", .p_value = 1e-9, .swing_period_s = 4.93},
                                  {.axis = "Y", .p_value = 1e-9},
                                  {.axis = "Z", .p_value = 1e-5, .swing_period_s = 5.1}};
  CHECK(verdict::what_swings(left) ==
        " What is left swings: X every 4.9 s, Z every 5.1 s, as by " + std::string{kWhatSwings} + ".");
  CHECK(verdict::what_swings(std::span{left}.subspan(1, 1)).empty());
}

// The sensor check in words: what agrees, what does not, what nobody can tell, each with its number.
#include "common/consistency/summary.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace fathom::consistency {
namespace {

Statement scale(const std::string& signal, double value, Answer answer) {
  return {.signal = signal,
          .reference = "pose_capture",
          .quantity = "scale",
          .unit = "",
          .answer = answer,
          .value = value,
          .sigma = 0.002,
          .neutral = 1.0,
          .seen = 0.01,
          .practical = 0.05};
}

ConsistencyResult of(std::vector<Statement> statements) {
  ConsistencyResult result;
  result.pairs["dvl"].statements = std::move(statements);
  return result;
}

}  // namespace

TEST_CASE("summary: a line per quantity with mismatch, answer and the fault that would have been seen") {
  Statement unseen = scale("dvl.w", 1.0, Answer::kCannotTell);
  unseen.sigma = std::numeric_limits<double>::infinity();
  const auto lines = table_of(of({scale("dvl.u", 1.2, Answer::kDisagree), unseen}));
  REQUIRE(lines.size() == 2);
  for (const char* words : {"dvl.u", "1.2 +- 0.002", "disagree", "a fault of 0.01"})
    CHECK(lines[0].find(words) != std::string::npos);
  CHECK(lines[1] == "cannot tell, for the motion does not show it: dvl.w scale");
}

TEST_CASE("summary: agreement is said of all quantities or of those that showed it, and not beside a finding") {
  const Statement good = scale("dvl.u", 1.001, Answer::kAgree), open = scale("dvl.w", 1.0, Answer::kCannotTell);
  CHECK(conclusion_of(of({good})) == "the sensors agree with each other, in all 1 quantities");
  CHECK(conclusion_of(of({good, open})).find("nobody can tell (dvl.w scale)") != std::string::npos);
  CHECK(conclusion_of(of({})).find("nothing can be compared") != std::string::npos);
  ConsistencyResult found = of({good});
  found.findings.push_back({.run = "all", .signal = "dvl.u", .finding = "scale"});
  CHECK(conclusion_of(found).empty());
}

TEST_CASE("summary: the way travelled is a quantity too, and only agrees where a twentieth would have been seen") {
  ConsistencyResult result = of({});
  result.distance = {.value = 1.0, .sigma = 0.004, .count = 1};
  result.distance_limit = 5.0;
  CHECK(conclusion_of(result).find("agree") != std::string::npos);
  result.distance.sigma = 0.02;
  CHECK(conclusion_of(result).find("agree") == std::string::npos);
}

TEST_CASE("summary: axes that the vehicle does not have are left out, and no others") {
  ConsistencyResult result = of({scale("dvl.u", 1.0, Answer::kAgree), scale("dvl.w", 1.0, Answer::kCannotTell),
                                 scale("dvl", 0.0, Answer::kAgree)});
  keep_axes(result, {true, true, false, false, false, true});
  const auto& left = result.pairs.at("dvl").statements;
  REQUIRE(left.size() == 2);
  CHECK(left[0].signal == "dvl.u");
  CHECK(left[1].signal == "dvl");
}

}  // namespace fathom::consistency

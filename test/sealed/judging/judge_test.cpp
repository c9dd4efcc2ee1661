// The scorer: what counts as named, as alias, as whole, as false alarm and as a wrong confident name.
#include "test/sealed/judging/judge.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "test/sealed/judging/rate.hpp"

namespace fathom::sealed {
namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

Json truth_of(const std::string& kind, const Names& names) {
  Json truth{{"seed", 1}, {"kind", kind}, {"base", Json::object()}, {"floor", {{"truth", 0.02}, {"base", 0.1}}}};
  truth["effects"] = Json::array();
  for (const auto& name : names)
    truth["effects"].push_back({{"name", name}, {"share", 0.15}, {"parameters", {{"T", 0.2}}}});
  return truth;
}

Json effect(const std::string& name, const Names& others = {}, double log_odds = 5.0) {
  return {
      {"name", name},
      {"accepted", true},
      {"alternatives", others},
      {"log_odds", log_odds},
      {"parameters", {{"time_constant", {{"value", 0.22}, {"std", 0.02}}}, {"own", {{"value", 1.0}, {"std", 1.0}}}}}};
}

Score judged(const Json& truth, const std::vector<Json>& effects, const std::string& verdict = "effect") {
  const Json error{{"prediction", {{{"horizon_s", 5}, {"r2", {{"u", 0.99}, {"v", 0.96}, {"p", nullptr}}}}}}};
  const Json result{{"verdict", verdict},
                    {"effects", effects},
                    {"consistency", Json::array()},
                    {"parameters", {{"after", Json::object()}}},
                    {"error", {{"before", error}, {"after", error}}}};
  return judge(truth, result, {{"seconds", 3.0}});
}

}  // namespace

TEST_CASE("judge: one effect") {
  const Json truth = truth_of("single", {"thruster_lag"});
  CHECK(judged(truth, {effect("thruster_lag")}).outcome == "named");
  CHECK(judged(truth, {effect("thruster_delay", {"thruster_lag", "wave"})}).outcome == "alias");
  CHECK(judged(truth, {effect("thruster_delay", {"thruster_lag", "wave", "current"})}).outcome == "wrong");
  CHECK(judged(truth, {effect("current"), effect("thruster_lag")}).outcome == "later");
  CHECK(judged(truth, {effect("current")}).outcome == "wrong");
  CHECK(judged(truth, {}).outcome == "missed");
  CHECK(judged(truth, {effect("thruster_lag"), effect("current")}).strangers == 1);
  CHECK(judged(truth, {effect("thruster_lag")}).size == "medium");
  CHECK(judge(truth, Json::object(), Json::object()).outcome == "failed");
}

TEST_CASE("judge: names of what a craft's own flow does are neither right nor wrong") {
  Json truth = truth_of("clean", {});
  truth["nature"] = {"body_lift"};
  const Score silent = judged(truth, {effect("body_lift")});
  CHECK(silent.outcome == "silent");
  CHECK(silent.verdict == "adequate");
  CHECK(silent.of_nature == 1);
  CHECK(judged(truth, {effect("body_lift"), effect("current")}).outcome == "false alarm");
  CHECK(judged(truth, {effect("body_lift")}, "unexplained").verdict == "unexplained");
  Json single = truth_of("single", {"thruster_lag"});
  single["nature"] = truth["nature"];
  const Score named = judged(single, {effect("body_lift"), effect("thruster_lag")});
  CHECK(named.outcome == "named");
  CHECK(named.strangers == 0);
  CHECK(named.found == Names{"thruster_lag"});
}

TEST_CASE("judge: pairs, silence and strangers") {
  const Json pair = truth_of("pair", {"current", "thruster_lag"});
  CHECK(judged(pair, {effect("thruster_lag"), effect("current")}).outcome == "whole");
  CHECK(judged(pair, {effect("thruster_delay", {"thruster_lag"}), effect("current")}).outcome == "whole");
  CHECK(judged(pair, {effect("current")}).outcome == "half");
  CHECK(judged(truth_of("clean", {}), {}).good);
  CHECK(judged(truth_of("noise", {"coloured_noise"}), {effect("current")}).outcome == "false alarm");
  const Json foreign = truth_of("foreign", {"rope_wrapping"});
  CHECK(judged(foreign, {}).outcome == "refused");
  CHECK(judged(foreign, {effect("current")}).outcome == "wrong name");
  CHECK(judged(foreign, {effect("current", {"wave"})}).outcome == "hesitant");
  CHECK(judged(foreign, {effect("current", {}, 0.5)}).outcome == "hesitant");
  CHECK(judged(foreign, {effect("current", {}, 0.5)}, "unexplained").outcome == "unexplained");
  CHECK(judged(foreign, {effect("current")}, "unexplained").outcome == "wrong name");
}

TEST_CASE("judge: beside something of no list right names are good, and a wrong one spoils them") {
  const Json many = truth_of("many", {"current", "thruster_lag", "payload_change"});
  CHECK(judged(many, {effect("current"), effect("payload_change"), effect("thruster_lag")}, "effect").outcome == "whole");
  CHECK(judged(many, {effect("current"), effect("thruster_lag")}, "unexplained").outcome == "part");
  CHECK_FALSE(judged(many, {effect("current"), effect("thruster_lag")}, "unexplained").good);
  CHECK(judged(many, {effect("current"), effect("thruster_lag"), effect("wave")}, "effect").outcome == "wrong");
  CHECK(judged(many, {}, "unexplained").outcome == "missed");
  const Json mixed = truth_of("mixed", {"current", "thruster_lag", "rope_wrapping"});
  CHECK(judged(mixed, {effect("current"), effect("thruster_lag")}, "unexplained").outcome == "whole");
  CHECK(judged(mixed, {effect("current")}, "unexplained").outcome == "half");
  CHECK(judged(mixed, {effect("current")}, "unexplained").good);
  CHECK(judged(mixed, {}, "unexplained").outcome == "missed");
  CHECK(judged(mixed, {effect("current"), effect("wave")}, "unexplained").outcome == "wrong");
}

TEST_CASE("judge: the right name for the wrong thruster is seen") {
  Json truth = truth_of("single", {"thruster_gain"}), found = effect("thruster_gain");
  truth["effects"][0]["form"] = "T1";
  for (const auto& [form, wrong] : {std::pair{"T1", false}, {"T3", true}, {"T3, T1", false}, {"T10", true}}) {
    found["variant"] = form;
    CHECK(judged(truth, {found}).wrong_form == wrong);
  }
}

TEST_CASE("judge: a lopsided interval counts on the side where the truth is") {
  Json one = effect("thruster_lag");
  one["parameters"]["time_constant"]["interval_95"] = {0.1, 0.23};  // the truth is 0.2, found 0.22
  const Score score = judged(truth_of("single", {"thruster_lag"}), {one});
  REQUIRE(score.deviations.size() == 1);
  CHECK(score.deviations.front() == doctest::Approx(1.96 * 0.02 / 0.12));
}

TEST_CASE("judge: numbers") {
  const Score score = judged(truth_of("single", {"thruster_lag"}), {effect("thruster_lag")});
  CHECK(score.after == doctest::Approx(0.5 * (0.1 + 0.2)));  // sqrt(1 - r2), mean over axes that are simulated
  REQUIRE(score.deviations.size() == 1);
  CHECK(score.deviations.front() == doctest::Approx(1.0));
  REQUIRE(score.claims.size() == 1);
  CHECK(score.claims.front().right);
  CHECK(score.claims.front().probability == doctest::Approx(0.99331).epsilon(1e-4));
}

TEST_CASE("rate: Wilson's interval") {
  // By hand, z = 1.96: 8 of 10 is (.8 + .1921) / 1.3841 -+ 1.96 / 1.3841 sqrt(.016 + .0096).
  const Rate most = wilson(8, 10), all = wilson(10, 10), none = wilson(0, 0);
  CHECK(most.share == doctest::Approx(0.8));
  CHECK(most.low == doctest::Approx(0.4902).epsilon(1e-3));
  CHECK(most.high == doctest::Approx(0.9433).epsilon(1e-3));
  CHECK(all.low == doctest::Approx(0.7225).epsilon(1e-3));  // n / (n + z^2)
  CHECK(all.high == doctest::Approx(1.0));
  CHECK(none.low == 0.0);
  CHECK(none.high == 1.0);
}

}  // namespace fathom::sealed

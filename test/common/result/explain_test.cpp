// result.json read back to the same result; the chain of reasons; two results compared.
#include "common/result/explain.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/error.hpp"
#include "common/report/json.hpp"
#include "common/report/table.hpp"
#include "common/report/text.hpp"
#include "test/support/diagnosis_fixture.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

struct Written {
  test::Scratch scratch;
  DiagnosisResult result = test::made_up_report({.samples = 0}).result;
  VerdictGiven given{
      .core = "",
      .causes = {{"named", 0.999, 0.95, "thruster_lag"}, {"residual_goes_with", 0.4, 0.1, "X with position"}},
      .refusals = {},
      .covariance_of = {"X_u", "m_X"},
      .covariance = {4.0, -0.5, -0.5, 0.25}};
  ResultOrigin origin{.command = "fathom diagnose --vehicle v.yaml --train a.csv", .files = {}};
  [[nodiscard]] std::string save(const std::string& name = "result.json") const {
    test::write_bytes(scratch.path(name), report::to_json(result, given, origin));
    return scratch.path(name);
  }
};

}  // namespace

TEST_CASE("result: what is read back is written the same again, byte for byte") {
  Written w;
  w.result.manoeuvre = "Turn on the spot.";
  w.result.wiring = WiringFault{{"T1 and T2 exchanged"}, 0.97};
  w.result.effects[1].told_apart = {{"tether_tension", "yaw steps", 62.0}};
  w.origin.files = {{.role = "vehicle", .run = "", .path = "v.yaml", .sha256 = std::string(64, 'a'), .bytes = 12}};
  const std::string path = w.save();
  const result::Stored stored = result::read_result(path);
  CHECK(report::to_json(stored.result, stored.given, stored.origin) == test::read_bytes(path));
  CHECK(result::read_result(w.scratch.path("")).result.vehicle == w.result.vehicle);  // its folder will do
}

TEST_CASE("result: a file of schema 1 is read, whatever else it tells") {
  const Written w;
  const std::string path = w.save();
  nlohmann::ordered_json old = nlohmann::ordered_json::parse(test::read_bytes(path));
  old["schema"] = 1;
  old["explained"] = 0.6;
  old["own_in_validation"] = {"current"};
  old["residual"]["goes_with"] = {{{"axis", "X"}, {"with", "depth"}, {"share", 0.4}, {"log_odds", 9.0}}};
  for (auto& effect : old["effects"]) {
    effect["error_reduction"] = 0.3;
    effect["corrupts"] = "X_u";
    effect["other_forms"] = {"T4 or T0"};
    effect["unlisted_alternative"] = "denser water below the depths visited";
  }
  for (auto& candidate : old["candidates"]) candidate["aliased_with"] = {"current"};
  test::write_bytes(w.scratch.path("old.json"), old.dump());
  const result::Stored stored = result::read_result(w.scratch.path("old.json")), today = result::read_result(path);
  CHECK(report::to_json(stored.result, stored.given, stored.origin) ==
        report::to_json(today.result, today.given, today.origin));
}

TEST_CASE("result: what is no result is refused in a line that says what it is") {
  const test::Scratch scratch;
  const auto said = [&](const std::string& text) {
    test::write_bytes(scratch.path("r.json"), text);
    return test::complaint_of<InputError>([&] { (void)result::read_result(scratch.path("r.json")); });
  };
  CHECK(said("{").find("is no result.json") != std::string::npos);
  CHECK(said("[1]").find("is no result.json") != std::string::npos);
  CHECK(said(R"({"schema": 1, "kind": "live trial"})").find("result of a live trial") != std::string::npos);
  CHECK(said(R"({"schema": 7, "fathom_version": "9"})").find("has schema 7, and this version reads 1 to 2") !=
        std::string::npos);
  CHECK(said(R"({"schema": 1, "verdict": 3})").find("is not as docs/schema") != std::string::npos);
  CHECK(test::complaint_of<InputError>([&] {
          (void)result::read_result(scratch.path("none.json"));
        }).find("cannot be read") != std::string::npos);
}

TEST_CASE("explain: every reason with its value and threshold, within the terminal") {
  Written w;
  w.result.paragraph = "Thrust comes late.";
  const std::string text = result::explained(result::read_result(w.save()));
  std::string flat;  // lines are wrapped
  for (const char c : text) {
    if (c != '\n' && (c != ' ' || flat.empty() || flat.back() != ' ')) flat += c;
    if (c == '\n' && !flat.empty() && flat.back() != ' ') flat += ' ';
  }
  for (const char* words :
       {"Beluga <test>: effect", "Thrust comes late.", "thruster lag: it is this cause: 92 %", "time_constant = 0.352",
        "or tether_tension: ", "threshold 0.4", "probability 0.999, threshold 0.95",
        "The residual goes with something that was measured: X with position",
        "fraction of the residual's variance 0.400, threshold 0.100", "What to do next"}) {
    CAPTURE(words);
    CHECK(flat.find(words) != std::string::npos);
  }
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);) CHECK(report::columns(line) <= report::kTableColumns);
}

TEST_CASE("explain: what is open is never called settled, and what was not asked has no number") {
  Written w;
  w.result.manoeuvre.clear();
  w.result.verdict = "unexplained";
  const std::string text = result::explained(result::read_result(w.save()));
  CHECK(text.find("Nothing is open") == std::string::npos);
  CHECK(text.find(": it is this cause: ") != std::string::npos);
  w.result.verdict = "adequate";
  CHECK(result::explained(result::read_result(w.save())).find("Nothing is open") != std::string::npos);
}

TEST_CASE("diff: effects that came and went, and the numbers that differ for sure") {
  Written before, after;
  after.result.verdict = "ambiguous";
  after.result.effects.erase(after.result.effects.begin());  // thruster_lag is repaired
  NamedValue& drag = after.result.parameters_after.front();
  const std::string name = drag.name;
  drag.value += 10.0 * std::max(drag.std, 0.01 * std::abs(drag.value));
  const std::string text =
      result::difference(result::read_result(before.save()), result::read_result(after.save("after.json")));
  CHECK(text.find("thruster lag: gone in B") != std::string::npos);
  CHECK(text.find("current: in both") != std::string::npos);
  CHECK(text.find("· " + name + ": ") != std::string::npos);
  CHECK(text.find("others agree within their uncertainty") != std::string::npos);
  const std::string same =
      result::difference(result::read_result(before.save()), result::read_result(before.save("again.json")));
  CHECK(same.find("· ") == std::string::npos);
  CHECK(same.find("gone") == std::string::npos);
}

}  // namespace fathom

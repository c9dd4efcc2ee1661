// result.json keeps its names and its types, whatever the numbers are.
#include "common/report/json.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "common/base/version.hpp"
#include "test/support/diagnosis_fixture.hpp"
#include "test/support/schema.hpp"

using fathom::report::to_json;
using nlohmann::json;

namespace {

std::vector<std::string> keys(const json& object) {
  std::vector<std::string> names;
  for (const auto& [name, value] : object.items()) names.push_back(name);
  return names;  // nlohmann::json sorts them
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("result.json holds exactly the promised names") {
  const json file = json::parse(to_json(fathom::test::made_up_report({.samples = 0}).result));
  CHECK(keys(file) == Names{"candidates",   "causes",    "command",        "consistency", "covariance", "data",
                            "effects",      "error",     "fathom_version", "files",       "kind",       "next",
                            "not_measured", "paragraph", "parameters",     "residual",    "schema",     "train",
                            "validate",     "vehicle",   "verdict"});
  CHECK(file["schema"] == 2);
  CHECK(file["fathom_version"] == fathom::version());
  CHECK(file["vehicle"] == "Beluga <test>");
  CHECK(file["verdict"] == "effect");
  CHECK(file["train"].size() == 5);
  CHECK(keys(file["consistency"][0]) ==
        Names{"action", "evidence", "finding", "reference", "run", "signal", "size", "unit"});
  CHECK(keys(file["effects"][0]) == Names{"accepted", "alternatives", "log_odds", "name", "parameters", "probability",
                                          "rivals", "sentence", "told_apart_by", "variant"});
  CHECK(file["effects"][1]["alternatives"] == json{"tether_tension"});
  CHECK(file["effects"][1]["rivals"][0]["name"] == "tether_tension");
  CHECK(file["effects"][1]["rivals"][0]["log_odds"] == 1.1);
  CHECK(keys(file["candidates"][0]) == Names{"log_odds", "name", "reason", "variant"});
  CHECK(keys(file["error"]) == Names{"after", "before", "foretold", "improvement"});
  CHECK(keys(file["error"]["before"]) == Names{"force_rmse", "prediction"});
  CHECK(keys(file["error"]["improvement"]) == Names{"ci95", "value"});
  CHECK(keys(file["parameters"]) == Names{"after", "before"});
  CHECK(keys(file["residual"]) == Names{"after", "before"});
  CHECK(keys(file["residual"]["after"]["X"]) ==
        Names{"autocorrelation_time_s", "explained", "p_value", "swing_period_s"});
}

TEST_CASE("What was not measured stands with the effects that could not be asked for it") {
  auto report = fathom::test::made_up_report({.samples = 0});
  report.result.not_measured = {{"attitude", {"current"}, "It is not known."}, {"position", {}}};
  const json file = json::parse(to_json(report.result));
  REQUIRE(file["not_measured"].size() == 2);
  CHECK(file["not_measured"][0] ==
        json({{"group", "attitude"}, {"cannot_be_asked", {"current"}}, {"means", "It is not known."}}));
  CHECK(file["not_measured"][1]["cannot_be_asked"].empty());
  CHECK(file["not_measured"][1]["means"] == "");
}

TEST_CASE("Thrusters that are not the file's stand in the file where there is doubt, and nowhere else") {
  auto report = fathom::test::made_up_report({.samples = 0});
  CHECK_FALSE(json::parse(to_json(report.result)).contains("wiring"));
  report.result.wiring = fathom::WiringFault{{"T1 and T2 exchanged"}, 0.97};
  CHECK(json::parse(to_json(report.result))["wiring"] ==
        json({{"readings", {"T1 and T2 exchanged"}}, {"error_reduction", 0.97}}));
}

TEST_CASE("Named values become objects with value, std and unit, and arrive unchanged") {
  const json file = json::parse(to_json(fathom::test::made_up_report({.samples = 0}).result));
  const json& lag = file["effects"][0]["parameters"]["time_constant"];
  CHECK(lag["value"] == 0.352);
  CHECK(lag["std"] == 0.012);
  CHECK(lag["unit"] == "s");
  CHECK(lag["interval_95"][1].get<double>() == doctest::Approx(0.352 + 1.96 * 0.012));
  CHECK(file["parameters"]["after"]["X_u|u|"]["value"] == -12.4);
  CHECK(file["effects"][0]["accepted"] == true);
  CHECK(file["error"]["improvement"]["ci95"] == json::array({0.36, 0.55}));
}

TEST_CASE("Effects and candidates keep their order") {
  const json file = json::parse(to_json(fathom::test::made_up_report({.samples = 0}).result));
  CHECK(file["effects"][0]["name"] == "thruster_lag");
  CHECK(file["effects"][1]["name"] == "current");
  CHECK(file["candidates"].size() == 10);
  CHECK(file["candidates"][5]["variant"] == "thruster 3");
}

TEST_CASE("Horizons are 1, 5 and 10, and axes are u v w p q r in SI units") {
  const auto report = fathom::test::made_up_report({.samples = 0});
  const json file = json::parse(to_json(report.result));
  const json& prediction = file["error"]["before"]["prediction"];
  REQUIRE(prediction.size() == 3);
  CHECK(prediction[0]["horizon_s"] == 1);
  CHECK(prediction[0]["horizon_s"].is_number_integer());
  CHECK(prediction[2]["horizon_s"] == 10);
  CHECK(keys(prediction[0]) == Names{"horizon_s", "p_average", "p_half", "r2", "rmse"});
  CHECK(keys(prediction[0]["rmse"]) == Names{"p", "q", "r", "u", "v", "w"});
  CHECK(prediction[1]["rmse"]["r"] == report.result.error_before.prediction[1].rmse[5]);
}

TEST_CASE("A number that does not exist is null") {
  auto result = fathom::test::made_up_report({.samples = 0}).result;
  result.improvement.low = std::numeric_limits<double>::infinity();
  const json file = json::parse(to_json(result));
  CHECK(file["error"]["before"]["prediction"][0]["rmse"]["p"].is_null());
  CHECK(file["error"]["before"]["prediction"][0]["r2"]["p"].is_null());
  CHECK(file["candidates"][9]["log_odds"].is_null());
  CHECK(file["parameters"]["before"]["W-B"]["std"].is_null());
  CHECK(file["error"]["improvement"]["ci95"][0].is_null());
}

TEST_CASE("An empty result is still a complete file") {
  const json file = json::parse(to_json({}));
  CHECK(file["effects"] == json::array());
  CHECK(file["candidates"] == json::array());
  CHECK(file["consistency"] == json::array());
  CHECK(file["parameters"]["before"] == json::object());
  CHECK(file["residual"]["after"] == json::object());
  CHECK(file["error"]["after"]["prediction"] == json::array());
}

TEST_CASE("Text that is not UTF-8 does not stop the file") {
  fathom::DiagnosisResult result;
  result.vehicle = "broken \xff name";
  const json file = json::parse(to_json(result));
  CHECK(file["vehicle"].is_string());
}

TEST_CASE("result.json holds the causes of a verdict and the refusals of candidates where they are given") {
  auto result = fathom::test::made_up_report({.samples = 0}).result;
  result.candidates = {{.name = "wave"}, {.name = "current"}};
  const fathom::VerdictGiven given{.core = "likelihood",
                                   .causes = {{"free_force", 12.5, 5.0, "depth in Z"}},
                                   .refusals = {{"wave", {{"odds", 3.0, 10.0}}}}};
  const json file = json::parse(to_json(result, given));
  CHECK(file["core"] == "likelihood");
  CHECK(file["causes"][0] == json{{"cause", "free_force"}, {"value", 12.5}, {"threshold", 5.0}, {"of", "depth in Z"}});
  CHECK(file["candidates"][0]["refusals"][0] == json{{"rule", "odds"}, {"value", 3.0}, {"needed", 10.0}});
  CHECK_FALSE(file["candidates"][1].contains("refusals"));
}

TEST_CASE("result.json says where it comes from, how sure its numbers are together, and what to fly next") {
  auto result = fathom::test::made_up_report({.samples = 0}).result;
  result.manoeuvre = "Turn on the spot.";
  result.effects[1].told_apart = {{"tether_tension", "yaw steps", 62.0}};
  const fathom::VerdictGiven given{.core = "",
                                   .causes = {},
                                   .refusals = {},
                                   .covariance_of = {"X_u", "m_X"},
                                   .covariance = {4.0, -0.5, -0.5, std::nan("")}};
  constexpr fathom::Utime kNoon = 1'716'811'200'000'000;  // 2024-05-27 12:00 UTC
  const fathom::ResultOrigin origin{
      .command = "fathom diagnose --vehicle v.yaml --train a.csv",
      .files = {{.role = "vehicle", .run = "", .path = "v.yaml", .sha256 = std::string(64, 'a'), .bytes = 12},
                {.role = "train",
                 .run = "a",
                 .path = "a.csv",
                 .sha256 = std::string(64, 'b'),
                 .bytes = 34,
                 .begin = kNoon,
                 .end = kNoon + 61'500'000}}};
  const std::string text = to_json(result, given, origin);
  const json file = json::parse(text);
  CHECK(file["command"] == origin.command);
  CHECK(file["data"]["begin"] == "2024-05-27T12:00:00.000Z");
  CHECK(file["data"]["end"] == "2024-05-27T12:01:01.500Z");
  CHECK(file["files"][1]["seconds"] == 61.5);
  CHECK_FALSE(file["files"][0].contains("run"));
  CHECK(file["covariance"]["names"] == json{"X_u", "m_X"});
  CHECK(file["covariance"]["matrix"][0] == json{4.0, -0.5});
  CHECK(file["covariance"]["matrix"][1][1].is_null());
  CHECK(file["next"]["words"] == "Turn on the spot.");
  CHECK(file["next"]["segments"][0] ==
        json{{"segment", "yaw steps"}, {"seconds", 62.0}, {"tells", "current"}, {"from", "tether_tension"}});
  const fathom::test::Scratch scratch;
  fathom::test::write_bytes(scratch.path("result.json"), text);
  CHECK(fathom::test::against_schema(scratch, scratch.path("result.json"), "diagnosis-2") == "");
}

TEST_CASE("Every result.json is as its schema says, and a wrong one is not") {
  const fathom::test::Scratch scratch;
  const std::string path = scratch.path("result.json");
  if (!fathom::test::python_has("jsonschema")) return;
  auto full = fathom::test::made_up_report({.samples = 0}).result;
  full.wiring = fathom::WiringFault{{"T1 and T2 exchanged"}, 0.97};
  full.not_measured = {{"attitude", {"current"}, "It is not known."}};
  full.correction = fathom::CorrectionGiven{.asked = true, .adopted = true};
  full.correction->terms = {{"depth", 2, {{"depth_bump", 0, 1, 2.0, 0.5, 0.0}}, 1.5, 0.3, 0.1}};
  full.correction->covariance = {{0.01}};
  full.correction->visited_force = {10.0};
  full.correction->left = {{"Z", 0.02, 0.2}};
  const fathom::VerdictGiven given{.core = "likelihood",
                                   .causes = {{"free_force", 12.5, 5.0, "depth in Z"}},
                                   .refusals = {{full.candidates[3].name, {{"odds", 3.0, 10.0}}}}};
  for (const std::string& text : {to_json(full, given), to_json({})}) {
    json file = json::parse(text);
    if (file["verdict"] == "") file["verdict"] = "adequate";  // a result that nobody has concluded
    fathom::test::write_bytes(path, file.dump());
    CHECK(fathom::test::against_schema(scratch, path, "diagnosis-2") == "");
  }
  json wrong = json::parse(to_json(full, given));
  wrong["causes"][0]["cause"] = "the weather";
  fathom::test::write_bytes(path, wrong.dump());
  CHECK(fathom::test::against_schema(scratch, path, "diagnosis-2") != "");
  wrong = json::parse(to_json(full, given));
  wrong["mood"] = "good";  // a key that the schema does not describe
  fathom::test::write_bytes(path, wrong.dump());
  CHECK(fathom::test::against_schema(scratch, path, "diagnosis-2") != "");
}

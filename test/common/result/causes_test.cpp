// Causes as data: what decided, with value and threshold; and each of them described in the schema.
#include "common/result/causes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/result/cause_words.hpp"
#include "test/support/diagnosis_fixture.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

DiagnosisResult unexplained() {
  DiagnosisResult result;
  result.verdict = "unexplained";
  result.goes_with = {{"X", "position", 0.4, 30.0, 0.2}};
  result.candidates = {{.name = "wave", .variant = "", .log_odds = 2.0, .error_reduction = 0.3}};
  return result;
}

const CauseGiven* find(const std::vector<CauseGiven>& causes, const std::string& name) {
  for (const CauseGiven& one : causes) {
    if (one.cause == name) return &one;
  }
  return nullptr;
}

}  // namespace

TEST_CASE("causes: the schema lists the same as the program, each with its quantity") {
  const auto schema =
      nlohmann::json::parse(test::read_bytes(std::string{FATHOM_SOURCE_DIR} + "/docs/schema/diagnosis-1.schema.json"));
  const auto& listed = schema.at("properties").at("causes").at("items").at("properties").at("cause").at("oneOf");
  REQUIRE(listed.size() == result::cause_words().size());
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const result::CauseWords& words = result::cause_words()[i];
    CHECK(listed[i].at("const") == words.cause);
    const std::string described = listed[i].at("description");
    CHECK(described.starts_with(std::string{words.sentence} + "."));
    CHECK(described.find(std::string{words.quantity}) != std::string::npos);
  }
}

TEST_CASE("causes: of an unexplained verdict, the residual's relations and the nearest candidate") {
  const auto causes = result::causes_of(unexplained());
  REQUIRE(find(causes, "residual_goes_with") != nullptr);
  CHECK(find(causes, "residual_goes_with")->value == 0.4);
  CHECK(find(causes, "residual_goes_with")->of == "X with position");
  REQUIRE(find(causes, "promising") != nullptr);
  CHECK(find(causes, "promising")->of == "wave");
  CHECK(find(causes, "promising")->threshold == 0.15);
  CHECK(find(causes, "nothing_found") == nullptr);
  CHECK(find(causes, "free_curve") == nullptr);
}

TEST_CASE("causes: of a verdict that nothing else decided, a form that no listed effect has") {
  DiagnosisResult result;
  result.verdict = "unexplained";
  const auto causes = result::causes_of(result);
  REQUIRE(causes.size() == 1);
  CHECK(causes[0].cause == "free_curve");
  CHECK(std::isnan(causes[0].value));
}

TEST_CASE("causes: a name with a rival is told as a probability against it") {
  DiagnosisResult result;
  result.verdict = "ambiguous";
  result.effects = {{.name = "current", .variant = "", .log_odds = 9.0}};
  result.effects[0].alternatives = {{.name = "tether_tension", .log_odds = std::log(3.0)}};
  const auto causes = result::causes_of(result);
  REQUIRE(causes.size() == 1);
  CHECK(causes[0].cause == "rivals");
  CHECK(causes[0].of == "current or tether_tension");
  CHECK(causes[0].value == doctest::Approx(0.75));  // 3 : 1
  CHECK(causes[0].threshold == doctest::Approx(20.0 / 21.0).epsilon(1e-3));
}

TEST_CASE("causes: nothing found, too short, and thrusters that are not the file's") {
  DiagnosisResult result;
  result.verdict = "adequate";
  result.candidates = {{.name = "wave", .variant = "", .log_odds = 1.5}};
  CHECK(result::causes_of(result)[0].cause == "nothing_found");
  CHECK(result::causes_of(result)[0].value == 1.5);
  result.verdict = "unjudged";
  CHECK(result::causes_of(result)[0].cause == "too_short");
  result.wiring = WiringFault{{"T1 reversed"}, 0.9};
  CHECK(result::causes_of(result)[0].of == "T1 reversed");
  for (const CauseGiven& one : result::causes_of(test::made_up_report({.samples = 0}).result))
    CHECK(result::words_of(one.cause) != nullptr);
}

TEST_CASE("covariance: rows of the numbers that are told, in physical units") {
  model::Vehicle vehicle;
  vehicle.dof = {true, false, false, false, false, false};
  vehicle.parameters = {"m_X", "X_u"};
  vehicle.priors = {{20.0, 10.0}, {-5.0, 10.0}};
  identification::FitResult fit;
  fit.model.vehicle = &vehicle;
  fit.covariance = Eigen::Matrix2d{{0.5, 0.1}, {0.1, 0.25}};
  VerdictGiven given;
  result::put_covariance(fit, given);
  CHECK(given.covariance_of == std::vector<std::string>{"m_X", "X_u"});
  CHECK(given.covariance == std::vector{0.5, 0.1, 0.1, 0.25});
  fit.covariance.resize(0, 0);
  VerdictGiven none;
  result::put_covariance(fit, none);
  CHECK(none.covariance_of.empty());
}

}  // namespace fathom

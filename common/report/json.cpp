// Writes result.json. Keys are a contract with other programs: under one number of the schema, never rename, only add.
#include "common/report/json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/version.hpp"
#include "common/report/correction.hpp"
#include "common/report/json_origin.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

using Json = nlohmann::ordered_json;

Json named(const std::vector<NamedValue>& values) {
  Json object = Json::object();
  for (const auto& v : values) {
    const auto [low, high] = v.range95();
    object[v.name] = {{"value", number_or_null(v.value)},
                      {"std", number_or_null(v.std)},
                      {"unit", v.unit},
                      {"interval_95", {number_or_null(low), number_or_null(high)}}};
  }
  return object;
}

Json per_axis(const std::array<double, 6>& values) {
  Json object = Json::object();
  for (std::size_t i = 0; i < values.size(); ++i) object[kAxes[i].velocity] = number_or_null(values[i]);
  return object;
}

// 1 s is written 1, as the schema shows it.
Json horizon(double seconds) {
  if (seconds == std::floor(seconds) && std::abs(seconds) < 1e9) return static_cast<long>(seconds);
  return number_or_null(seconds);
}

Json error(const ModelError& error) {
  Json force = Json::object();
  for (const auto& [axis, rmse] : error.force_rmse) force[axis] = number_or_null(rmse);
  Json prediction = Json::array();
  for (const auto& p : error.prediction) {
    prediction.push_back({{"horizon_s", horizon(p.horizon_s)},
                          {"rmse", per_axis(p.rmse)},
                          {"r2", per_axis(p.r2)},
                          {"p_half", per_axis(p.p_half)},
                          {"p_average", per_axis(p.p_average)}});
  }
  return {{"force_rmse", force}, {"prediction", prediction}};
}

Json whiteness(const std::vector<AxisWhiteness>& axes) {
  Json object = Json::object();
  for (const auto& axis : axes) {
    object[axis.axis] = {{"p_value", number_or_null(axis.p_value)},
                         {"autocorrelation_time_s", number_or_null(axis.autocorrelation_time_s)},
                         {"swing_period_s", number_or_null(axis.swing_period_s)},
                         {"explained", number_or_null(axis.explained)}};
  }
  return object;
}

Json consistency(const std::vector<ConsistencyFinding>& findings) {
  Json array = Json::array();
  for (const auto& f : findings) {
    array.push_back({{"run", f.run},
                     {"signal", f.signal},
                     {"reference", f.reference},
                     {"finding", f.finding},
                     {"size", number_or_null(f.size)},
                     {"unit", f.unit},
                     {"evidence", f.evidence},
                     {"action", f.action}});
  }
  return array;
}

Json effects(const std::vector<EffectFound>& found) {
  Json array = Json::array();
  for (const auto& e : found) {
    Json told_apart = Json::array();
    for (const auto& t : e.told_apart)
      told_apart.push_back({{"name", t.name}, {"segment", t.segment}, {"seconds", number_or_null(t.seconds)}});
    Json names = Json::array(), rivals = Json::array();
    for (const Alternative& other : e.alternatives) {
      names.push_back(other.name);
      rivals.push_back({{"name", other.name}, {"log_odds", number_or_null(other.log_odds)}});
    }
    array.push_back({{"name", e.name},
                     {"variant", e.variant},
                     {"accepted", e.accepted},
                     {"parameters", named(e.parameters)},
                     {"log_odds", number_or_null(e.log_odds)},
                     {"probability", number_or_null(e.probability)},
                     {"alternatives", names},
                     {"rivals", rivals},
                     {"told_apart_by", told_apart},
                     {"sentence", e.sentence}});
  }
  return array;
}

Json stand_ins(const std::vector<StandIn>& found) {
  Json array = Json::array();
  for (const StandIn& one : found)
    array.push_back({{"name", one.name},
                     {"variant", one.variant},
                     {"in_model", one.in_model},
                     {"size", number_or_null(one.size)},
                     {"over", number_or_null(one.over)},
                     {"modulation", number_or_null(one.modulation)},
                     {"parameters", named(one.parameters)}});
  return array;
}

Json candidates(const std::vector<CandidateTried>& tried, const VerdictGiven& given) {
  Json array = Json::array();
  for (const auto& c : tried) {
    array.push_back(
        {{"name", c.name}, {"variant", c.variant}, {"log_odds", number_or_null(c.log_odds)}, {"reason", c.reason}});
    const auto found = given.refusals.find(c.name);
    if (found == given.refusals.end()) continue;
    Json refusals = Json::array();
    for (const auto& refusal : found->second)
      refusals.push_back({{"rule", refusal.rule},
                          {"value", number_or_null(refusal.value)},
                          {"needed", number_or_null(refusal.needed)}});
    array.back()["refusals"] = refusals;
  }
  return array;
}

Json causes(const std::vector<CauseGiven>& given) {
  Json array = Json::array();
  for (const auto& cause : given) {
    array.push_back({{"cause", cause.cause},
                     {"value", number_or_null(cause.value)},
                     {"threshold", number_or_null(cause.threshold)},
                     {"of", cause.of}});
  }
  return array;
}

Json skill(const std::vector<SkillGiven>& rows) {
  Json array = Json::array();
  for (const auto& row : rows) {
    array.push_back({{"horizon_s", row.horizon_s},
                     {"axis", row.axis},
                     {"rmse", number_or_null(row.rmse)},
                     {"rmse_unchanged", number_or_null(row.rmse_unchanged)},
                     {"rmse_plain", number_or_null(row.rmse_plain)},
                     {"over_unchanged", number_or_null(row.over_unchanged)},
                     {"over_plain", number_or_null(row.over_plain)}});
  }
  return array;
}

Json explainable(const std::vector<ExplainableGiven>& rows) {
  Json array = Json::array();
  for (const auto& row : rows) array.push_back({{"axis", row.axis}, {"share", number_or_null(row.share)}});
  return array;
}

Json not_measured(const std::vector<NotMeasured>& groups) {
  Json array = Json::array();
  for (const auto& g : groups)
    array.push_back({{"group", g.group}, {"cannot_be_asked", g.cannot_be_asked}, {"means", g.means}});
  return array;
}

/// Covariance of parameters.after and of the effects' numbers, under names that say whose they are.
Json covariance(const VerdictGiven& given) {
  const std::size_t n = given.covariance_of.size();
  if (n == 0 || given.covariance.size() != n * n) return nullptr;
  Json rows = Json::array();
  for (std::size_t i = 0; i < n; ++i) {
    Json row = Json::array();
    for (std::size_t j = 0; j < n; ++j) row.push_back(number_or_null(given.covariance[i * n + j]));
    rows.push_back(row);
  }
  return {{"names", given.covariance_of}, {"matrix", rows}};
}

/// What to fly next: in words, and the segments of a site that were computed to tell look-alikes apart.
Json next(const DiagnosisResult& result) {
  Json segments = Json::array();
  for (const EffectFound& effect : result.effects) {
    for (const ToldApart& told : effect.told_apart) {
      segments.push_back({{"segment", told.segment},
                          {"seconds", number_or_null(told.seconds)},
                          {"tells", effect.name},
                          {"from", told.name}});
    }
  }
  return {{"words", result.manoeuvre}, {"segments", segments}};
}

}  // namespace

std::string to_json(const DiagnosisResult& result, const VerdictGiven& given, const ResultOrigin& origin) {
  Json improvement;
  improvement["value"] = number_or_null(result.improvement.value);
  improvement["ci95"] = Json::array({number_or_null(result.improvement.low), number_or_null(result.improvement.high)});

  Json file;
  begin_result(file, kDiagnosisSchema, "diagnosis", origin);
  file["vehicle"] = result.vehicle;
  file["train"] = result.train;
  file["validate"] = result.validate;
  file["consistency"] = consistency(result.consistency);
  file["verdict"] = result.verdict;
  if (!given.core.empty()) {
    file["core"] = given.core;
    file["skill"] = skill(given.skill);
    file["explainable"] = explainable(given.explainable);
  }
  file["causes"] = causes(given.causes);
  file["paragraph"] = result.paragraph;
  file["next"] = next(result);
  file["effects"] = effects(result.effects);
  if (!result.stand_ins.empty()) file["stand_ins"] = stand_ins(result.stand_ins);
  if (result.correction && result.correction->asked) file["correction"] = correction_json(*result.correction);
  file["candidates"] = candidates(result.candidates, given);
  file["not_measured"] = not_measured(result.not_measured);
  file["error"]["before"] = error(result.error_before);
  file["error"]["after"] = error(result.error_after);
  file["error"]["improvement"] = improvement;
  file["error"]["foretold"] = {{"windows", result.foretold.windows},
                               {"cut", result.foretold.cut},
                               {"typical_s", number_or_null(result.foretold.typical)}};
  file["parameters"]["before"] = named(result.parameters_before);
  file["parameters"]["after"] = named(result.parameters_after);
  file["covariance"] = covariance(given);
  if (result.wiring)
    file["wiring"] = {{"readings", result.wiring->readings}, {"error_reduction", result.wiring->error_reduction}};
  file["residual"]["before"] = whiteness(result.residual_before);
  file["residual"]["after"] = whiteness(result.residual_after);
  return file.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string check_json(const CheckGiven& check) {
  const Json file{{"schema", kCheckSchema},
                  {"kind", "check"},
                  {"fathom_version", std::string{version()}},
                  {"vehicle", check.vehicle},
                  {"runs", check.runs},
                  {"conclusion", check.conclusion},
                  {"compared", check.compared},
                  {"consistency", consistency(check.findings)},
                  {"notes", check.notes}};
  return file.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace fathom::report

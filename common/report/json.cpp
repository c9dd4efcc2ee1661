// Writes result.json. Keys are a contract with other programs: never rename, only add.
#include "common/report/json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/version.hpp"
#include "common/report/correction.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json named(const std::vector<NamedValue>& values) {
  Json object = Json::object();
  for (const auto& v : values) {
    const auto [low, high] = v.range95();
    object[v.name] = {{"value", finite(v.value)},
                      {"std", finite(v.std)},
                      {"unit", v.unit},
                      {"interval_95", {finite(low), finite(high)}}};
  }
  return object;
}

Json per_axis(const std::array<double, 6>& values) {
  Json object = Json::object();
  for (std::size_t i = 0; i < values.size(); ++i) object[kAxes[i].velocity] = finite(values[i]);
  return object;
}

// 1 s is written 1, as the schema shows it.
Json horizon(double seconds) {
  if (seconds == std::floor(seconds) && std::abs(seconds) < 1e9) return static_cast<long>(seconds);
  return finite(seconds);
}

Json error(const ModelError& error) {
  Json force = Json::object();
  for (const auto& [axis, rmse] : error.force_rmse) force[axis] = finite(rmse);
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
    object[axis.axis] = {{"p_value", finite(axis.p_value)},
                         {"autocorrelation_time_s", finite(axis.autocorrelation_time_s)},
                         {"explained", finite(axis.explained)}};
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
                     {"size", finite(f.size)},
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
      told_apart.push_back({{"name", t.name}, {"segment", t.segment}, {"seconds", finite(t.seconds)}});
    Json names = Json::array(), rivals = Json::array();
    for (const Alternative& other : e.alternatives) {
      names.push_back(other.name);
      rivals.push_back({{"name", other.name},
                        {"log_odds", finite(other.log_odds)},
                        {"corrupts", other.corrupts},
                        {"corruption", finite(other.corruption)}});
    }
    array.push_back({{"name", e.name},
                     {"variant", e.variant},
                     {"accepted", e.accepted},
                     {"parameters", named(e.parameters)},
                     {"log_odds", finite(e.log_odds)},
                     {"error_reduction", finite(e.error_reduction)},
                     {"alternatives", names},
                     {"rivals", rivals},
                     {"corrupts", e.corrupts},
                     {"corruption", finite(e.corruption)},
                     {"unlisted_alternative", e.unlisted},
                     {"told_apart_by", told_apart},
                     {"other_forms", e.other_forms},
                     {"acts_last", e.last},
                     {"sentence", e.sentence}});
  }
  return array;
}

Json candidates(const std::vector<CandidateTried>& tried, const VerdictGiven& given) {
  Json array = Json::array();
  for (const auto& c : tried) {
    array.push_back({{"name", c.name},
                     {"variant", c.variant},
                     {"log_odds", finite(c.log_odds)},
                     {"error_reduction", finite(c.error_reduction)},
                     {"aliased_with", c.aliased_with},
                     {"reason", c.reason}});
    const auto found = given.refusals.find(c.name);
    if (found == given.refusals.end()) continue;
    Json refusals = Json::array();
    for (const auto& refusal : found->second)
      refusals.push_back(
          {{"rule", refusal.rule}, {"value", finite(refusal.value)}, {"needed", finite(refusal.needed)}});
    array.back()["refusals"] = refusals;
  }
  return array;
}

Json causes(const std::vector<CauseGiven>& given) {
  Json array = Json::array();
  for (const auto& cause : given) {
    array.push_back({{"cause", cause.cause},
                     {"value", finite(cause.value)},
                     {"threshold", finite(cause.threshold)},
                     {"of", cause.of}});
  }
  return array;
}

Json skill(const std::vector<SkillGiven>& rows) {
  Json array = Json::array();
  for (const auto& row : rows) {
    array.push_back({{"horizon_s", row.horizon_s},
                     {"axis", row.axis},
                     {"rmse", finite(row.rmse)},
                     {"rmse_unchanged", finite(row.rmse_unchanged)},
                     {"rmse_plain", finite(row.rmse_plain)},
                     {"over_unchanged", finite(row.over_unchanged)},
                     {"over_plain", finite(row.over_plain)}});
  }
  return array;
}

Json explainable(const std::vector<ExplainableGiven>& rows) {
  Json array = Json::array();
  for (const auto& row : rows) array.push_back({{"axis", row.axis}, {"share", finite(row.share)}});
  return array;
}

Json not_measured(const std::vector<NotMeasured>& groups) {
  Json array = Json::array();
  for (const auto& g : groups)
    array.push_back({{"group", g.group}, {"cannot_be_asked", g.cannot_be_asked}, {"means", g.means}});
  return array;
}

Json associations(const std::vector<Association>& left) {
  Json array = Json::array();
  for (const auto& a : left) {
    array.push_back({{"axis", a.axis},
                     {"with", a.with},
                     {"share", finite(a.share)},
                     {"log_odds", finite(a.log_odds)},
                     {"of_wrench", finite(a.of_wrench)}});
  }
  return array;
}

}  // namespace

std::string to_json(const DiagnosisResult& result, const VerdictGiven& given) {
  Json improvement;
  improvement["value"] = finite(result.improvement.value);
  improvement["ci95"] = Json::array({finite(result.improvement.low), finite(result.improvement.high)});

  Json file;
  file["schema"] = kSchema;
  file["fathom_version"] = version();
  file["vehicle"] = result.vehicle;
  file["train"] = result.train;
  file["validate"] = result.validate;
  file["consistency"] = consistency(result.consistency);
  file["verdict"] = result.verdict;
  if (!given.core.empty()) {
    file["core"] = given.core;
    file["causes"] = causes(given.causes);
    file["skill"] = skill(given.skill);
    file["explainable"] = explainable(given.explainable);
    file["paragraph"] = result.paragraph;
  }
  file["effects"] = effects(result.effects);
  if (result.correction && result.correction->asked) file["correction"] = correction_json(*result.correction);
  file["candidates"] = candidates(result.candidates, given);
  file["not_measured"] = not_measured(result.not_measured);
  file["error"]["before"] = error(result.error_before);
  file["error"]["after"] = error(result.error_after);
  file["error"]["improvement"] = improvement;
  file["parameters"]["before"] = named(result.parameters_before);
  file["parameters"]["after"] = named(result.parameters_after);
  file["explained"] = result.explained;
  if (!result.own_in_validation.empty()) file["own_in_validation"] = result.own_in_validation;
  if (result.wiring)
    file["wiring"] = {{"readings", result.wiring->readings}, {"error_reduction", result.wiring->error_reduction}};
  file["residual"]["before"] = whiteness(result.residual_before);
  file["residual"]["after"] = whiteness(result.residual_after);
  file["residual"]["goes_with"] = associations(result.goes_with);
  return file.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace fathom::report

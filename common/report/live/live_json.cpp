// result.json of a live trial. Keys are a contract with other programs: never rename, only add.
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/report/json_origin.hpp"
#include "common/report/live/live_trial.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

using Json = nlohmann::ordered_json;

Json truth_of(const LiveTrialResult& result) {
  const TruthComparison& truth = *result.truth;
  Json parameters = Json::object();
  for (const NamedValue& p : result.parameters) {
    const auto found = truth.parameters.find(p.name);
    if (found == truth.parameters.end()) continue;
    const double error = p.value - found->second;
    parameters[p.name] = {{"truth", found->second},
                          {"error", number_or_null(error)},
                          {"relative_error", number_or_null(error / std::abs(found->second))},
                          {"inside_interval", std::abs(error) <= kNormal95 * p.std}};
  }
  Json state = Json::object();
  constexpr std::array kNames{"x", "y", "z", "u", "v", "w"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    state[kNames[i]] = {{"rms", number_or_null(truth.state_rms[i])},
                        {"largest", number_or_null(truth.state_worst[i])},
                        {"normalised_square", number_or_null(truth.state_normalised[i])}};
  }
  return {{"parameters", parameters},
          {"state_error", state},
          {"states_compared", truth.compared},
          {"hidden_effects", truth.effect_names},
          {"contacts", {{"walls", truth.contacts[0]}, {"floor", truth.contacts[1]}, {"surface", truth.contacts[2]}}}};
}

}  // namespace

std::string to_json(const LiveTrialResult& result, const ResultOrigin& origin) {
  Json json;
  begin_result(json, kLiveTrialSchema, "live trial", origin);
  json["vehicle"] = result.vehicle;
  json["site"] = result.site;
  json["seconds"] = result.seconds;
  json["phase"] = result.phase;
  json["reason"] = result.reason;
  json["settled"] = result.settled();
  json["modes"] = Json::array();
  for (const ModeVisit& visit : result.visits) {
    json["modes"].push_back({{"mode", visit.mode},
                             {"begun_s", visit.begun},
                             {"ended_s", visit.ended},
                             {"settled", visit.left},
                             {"metric", visit.metric < 0.0 ? Json(nullptr) : number_or_null(visit.metric)},
                             {"threshold", number_or_null(visit.threshold)},
                             {"missing", visit.missing}});
  }
  json["flights"] = Json::array();
  for (const FlownSegment& flight : result.flights)
    json["flights"].push_back({{"segment", flight.segment}, {"begun_s", flight.begun}, {"ended_s", flight.ended}});
  json["estimate"] = result.joint ? "joint" : "recursive";
  json["joint_from_s"] = result.joint_from ? Json(*result.joint_from) : Json(nullptr);
  json["residual_fails_on"] = result.failing;
  json["parameters"] = Json::object();
  const std::vector<double>& inflation = result.entangled.inflation;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const NamedValue& p = result.parameters[i];
    json["parameters"][p.name] = {
        {"value", number_or_null(p.value)},
        {"std", number_or_null(p.std)},
        {"interval_95", {number_or_null(p.value - kNormal95 * p.std), number_or_null(p.value + kNormal95 * p.std)}},
        {"unit", p.unit},
        {"variance_inflation", i < inflation.size() ? number_or_null(inflation[i]) : Json(nullptr)}};
  }
  json["condition_of_correlations"] = inflation.empty() ? Json(nullptr) : number_or_null(result.entangled.condition);
  json["adopted_effects"] = result.adopted;
  json["effect_parameters"] = Json::object();
  for (const NamedValue& p : result.effect_numbers) {
    json["effect_parameters"][p.name] = {
        {"value", number_or_null(p.value)}, {"std", number_or_null(p.std)}, {"unit", p.unit}};
  }
  json["diagnosis"] = {{"verdict", result.ranking.verdict},
                       {"against", result.ranking.against},
                       {"segment", result.ranking.segment},
                       {"candidates", Json::array()}};
  for (const EffectEvidence& one : result.ranking.candidates) {
    json["diagnosis"]["candidates"].push_back({{"name", one.name},
                                               {"log_odds", number_or_null(one.log_odds)},
                                               {"error_reduction", number_or_null(one.error_reduction)}});
  }
  if (result.learned) {
    const LearnedTold& learned = *result.learned;
    json["diagnosis"]["learned"] = {{"adopted", learned.adopted},
                                    {"words", learned.words},
                                    {"equation", learned.equation},
                                    {"log_odds", number_or_null(learned.log_odds)},
                                    {"error_where_not_fitted", number_or_null(learned.held_out)}};
  }
  if (result.afterwards) {
    Json effects = Json::array();
    for (const EffectEvidence& one : result.afterwards->effects)
      effects.push_back({{"name", one.name}, {"log_odds", number_or_null(one.log_odds)}});
    const std::optional<double>& improvement = result.afterwards->improvement;
    json["closed_loop"] = {{"verdict", result.afterwards->verdict},
                           {"effects", effects},
                           {"improvement", improvement ? number_or_null(*improvement) : Json(nullptr)},
                           {"report", result.afterwards->page}};
  }
  json["complaints"] = Json::object();
  for (const auto& [process, words] : result.complaints) json["complaints"][process] = words;
  if (result.truth) json["compared_with_truth"] = truth_of(result);
  return json.dump(2) + "\n";
}

}  // namespace fathom::report

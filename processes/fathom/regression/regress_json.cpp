#include "processes/fathom/regression/regress_json.hpp"

#include <nlohmann/json.hpp>

#include "common/base/version.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::tool {
namespace {

using Json = nlohmann::ordered_json;

Json of(const identification::StepwiseResult& result, const identification::AxisCandidates& candidates) {
  const auto name = [&](int column) { return candidates.names[static_cast<std::size_t>(column)]; };
  const auto equivalents = [&](const identification::SelectedTerm& term) {
    Json names = Json::array();
    for (const int column : term.equivalents) names.push_back(name(column));
    return names;
  };
  Json terms = Json::array(), refused = Json::array();
  for (const auto& term : result.terms)
    terms.push_back({{"name", name(term.column)},
                     {"value", term.value},
                     {"std", term.total()},
                     {"std_of_scatter", term.sigma},
                     {"beyond_errors", term.beyond_errors()},
                     {"stands", term.stands()},
                     {"equivalents", equivalents(term)},
                     {"f", term.f},
                     {"p", term.p}});
  for (const auto& one : result.refused) refused.push_back({{"name", name(one.column)}, {"why", one.why}});
  const int most = result.most_significant;
  return {{"terms", terms},
          {"most_significant", most >= 0 ? Json(name(result.terms[static_cast<std::size_t>(most)].column)) : Json()},
          {"refused", refused},
          {"phi", result.phi},
          {"phi_std", result.phi_sigma},
          {"sigma", result.sigma},
          {"samples", result.samples},
          {"effective_samples", result.effective_samples},
          {"explained", result.explained},
          {"cross_validated", result.cross_validated}};
}

}  // namespace

std::string regression_json(const std::vector<identification::AxisRegression>& axes,
                            std::span<const identification::ManoeuvreRows> runs, const model::Vehicle& vehicle,
                            const identification::RegressionSettings& settings) {
  Json all{{"schema", "fathom-regression-1"}, {"fathom_version", version()}, {"vehicle", vehicle.name}};
  if (!runs.empty()) all["forces_from"] = runs.front().known_from;
  all["current_north_m_s"] = settings.v_WF.x();
  all["current_east_m_s"] = settings.v_WF.y();
  for (const auto& axis : axes) {
    Json one{{"axis", model::kAxisNames[static_cast<std::size_t>(axis.axis)]}};
    for (std::size_t i = 0; i < runs.size(); ++i) {
      Json of_run = of(axis.manoeuvres[i], axis.candidates);
      of_run["name"] = runs[i].name;
      one["manoeuvres"].push_back(of_run);
    }
    one["together"] = of(axis.together, axis.candidates);
    for (const auto& known : vehicle.hydrodynamics->reference) {
      for (std::size_t j = 0; j < axis.candidates.terms.size(); ++j) {
        if (axis.candidates.terms[j] == known.term)
          one["reference"].push_back(
              {{"name", axis.candidates.names[j]}, {"value", known.value}, {"std", known.error}});
      }
    }
    all["axes"].push_back(one);
  }
  return all.dump(2) + "\n";
}

}  // namespace fathom::tool

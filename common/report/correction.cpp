#include "common/report/correction.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/model/learned/factors/factor_kind.hpp"
#include "common/model/learned/told.hpp"
#include "common/report/correction_figures.hpp"
#include "common/report/page_parts.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t kMostCurves = 8;

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string factor_words(const CorrectionFactor& told) {
  const auto factor = model::factor_of(told);
  return factor ? model::kind_of(factor->quantity).words(*factor) : told.quantity;
}

}  // namespace

Json correction_json(const CorrectionGiven& given) {
  Json terms = Json::array();
  for (const CorrectionTerm& term : given.terms) {
    Json factors = Json::array();
    for (const CorrectionFactor& f : term.factors) {
      factors.push_back(
          {{"quantity", f.quantity}, {"index", f.index}, {"bank", f.bank}, {"a", f.a}, {"b", f.b}, {"c", f.c}});
      if (f.d != 0.0) factors.back()["d"] = f.d;
      if (!f.column.empty()) factors.back()["column"] = f.column;
    }
    terms.push_back({{"group", term.group},
                     {"axis", term.axis},
                     {"factors", factors},
                     {"scale", term.scale},
                     {"weight", term.weight},
                     {"std", finite(term.sigma)},
                     {"law", term.law}});
  }
  Json left = Json::array();
  for (const CorrectionLeft& one : given.left)
    left.push_back({{"axis", one.axis}, {"share", finite(one.share)}, {"share_without", finite(one.before)}});
  Json json;
  json["adopted"] = given.adopted;
  json["carried_to_other_runs"] = given.carried;
  json["stands_in_later_runs"] = given.goes_on;
  json["refused"] = given.refused;
  json["words"] = given.words;
  if (!given.look_for.empty()) json["look_for"] = given.look_for;
  json["log_odds"] = finite(given.log_odds);
  json["size"] = finite(given.size);
  json["error_where_not_fitted"] = {{"ratio", finite(given.held_out)},
                                    {"ratio_without_time", finite(given.held_out_carried)},
                                    {"predictions", given.windows},
                                    {"with_shortened_horizon", given.shortened}};
  if (!given.adopted) return json;
  json["terms"] = terms;
  json["covariance"] = given.covariance;
  json["input_is_wrench"] = given.input_is_wrench;
  json["visited"] = {{"nu", given.visited_nu},
                     {"tau", given.visited_tau},
                     {"force", given.visited_force},
                     {"p_low", given.visited_low},
                     {"p_high", given.visited_high}};
  json["left"] = left;
  json["prediction_std"] = Json::array();
  for (const double std : given.prediction_std) json["prediction_std"].push_back(finite(std));
  json["not_visited"] = finite(given.not_visited);
  if (given.formula) {
    Json numbers = Json::object();
    for (const NamedValue& number : given.formula->numbers)
      numbers[number.name] = {{"value", finite(number.value)}, {"std", finite(number.std)}, {"unit", number.unit}};
    json["formula"] = {{"equation", given.formula->equation},
                       {"numbers", numbers},
                       {"nats_over_features", finite(given.formula->over_learned)},
                       {"words", given.formula->words}};
  }
  return json;
}

std::string correction_words(const DiagnosisResult& result) {
  if (!result.correction || !result.correction->asked) return "";
  const CorrectionGiven& given = *result.correction;
  if (given.adopted) return given.words;
  return "What no listed effect explains could not be made a part of the model: " + given.refused + ".";
}

std::string correction_line(const CorrectionGiven& given) {
  std::vector<std::string> kinds;  // the strongest first, as they were found
  for (const CorrectionTerm& term : given.terms) {
    if (std::ranges::find(kinds, term.group) == kinds.end()) kinds.push_back(term.group);
  }
  constexpr std::size_t kShort = 60;  // characters: what is longer is read in the section
  const std::string where = given.terms.empty() ? "" : model::where(given.terms.front());
  const bool told = where.empty() && given.formula && given.formula->equation.size() <= kShort;
  std::string with = told ? given.formula->equation : kinds.empty() ? "" : kinds.front();
  if (!where.empty()) with += ": " + where;
  if (!told && kinds.size() > 1)
    with += (where.empty() ? " and " : ", and ") + std::to_string(kinds.size() - 1) + " more";
  return "<b>A correction, not a cause: a learned force, " + percent(given.size) + " of the applied force</b>" +
         (with.empty() ? "" : " (" + escape(with) + ")") + "; where its weights were not fitted, the error is " +
         percent(1.0 - given.held_out) + " lower" +
         (given.look_for.empty() ? "" : ". <b>Look for " + escape(given.look_for) + "</b>") +
         "<details><summary>what it is, and what is left</summary>" + escape(given.words) + "</details>";
}

std::string correction_section(const DiagnosisResult& result, Album* album) {
  const std::string words = correction_words(result);
  if (words.empty()) return "";
  std::string html = "<section><h2>A correction, not a cause</h2>\n<p class=\"lead\">" + escape(words) + "</p>\n";
  const CorrectionGiven& given = *result.correction;
  if (!given.adopted) return html + "</section>\n";
  if (given.formula) {
    html += "<p class=\"equation\">" + escape(given.formula->equation) +
            "</p>\n<table><tr><th>number</th><th>value</th>"
            "<th>95 % interval</th></tr>\n";
    for (const NamedValue& one : given.formula->numbers)
      html += "<tr><td>" + escape(one.name) + "</td><td>" + number(one.value) + "</td><td>" +
              number(one.value - 1.96 * one.std) + " to " + number(one.value + 1.96 * one.std) + " " +
              escape(one.unit) + "</td></tr>\n";
    html += "</table>\n";
  }
  if (album != nullptr) {
    const std::vector<CorrectionCurve> curves = correction_curves(given);
    for (std::size_t i = 0; i < curves.size() && i < kMostCurves; ++i) html += album->place(draw_correction(curves[i]));
    if (!curves.empty())
      html +=
          "<p>The force over what it goes with, with its 95 % band, as far as the recording has been; what else it "
          "reads stays at half of what was visited.</p>\n";
  }
  html +=
      "<p>Each term is its weight times a scale times what it goes with; it fades where the recording has not been. "
      "result.json holds all of it, with the weights' covariance.</p>\n<details><summary>Terms</summary><table><tr>"
      "<th>along</th><th>goes with</th><th>amplitude [N, N m per product]</th><th>its deviation</th></tr>\n";
  for (const CorrectionTerm& term : given.terms) {
    std::string product;
    for (const CorrectionFactor& factor : term.factors)
      product += (product.empty() ? "" : " · ") + factor_words(factor);
    html += "<tr><td>" + escape(model::direction_words(term.axis)) + "</td><td>" +
            escape(product.empty() ? "always" : product) + "</td><td>" + number(term.weight * term.scale) +
            "</td><td>" + number(term.sigma * term.scale) + "</td></tr>\n";
  }
  return html + "</table></details></section>\n";
}

}  // namespace fathom::report

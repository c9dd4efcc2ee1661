#include "processes/fathom/regression/regress_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/motions.hpp"
#include "common/model/vehicle.hpp"
#include "common/report/page_parts.hpp"
#include "common/report/pictures.hpp"
#include "common/report/text.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::tool {
namespace {

using identification::AxisRegression;
using identification::SelectedTerm;
using identification::StepwiseResult;
using report::cell;
using report::escape;
using report::percent;

const char* letter(const AxisRegression& axis) { return model::kAxisNames[static_cast<std::size_t>(axis.axis)]; }
const char* motion(const AxisRegression& axis) { return kMotionNames[static_cast<std::size_t>(axis.axis)]; }

const std::string& name_of(const AxisRegression& axis, int column) {
  return axis.candidates.names[static_cast<std::size_t>(column)];
}

/// Value and standard error of the vehicle file's reference; nothing where it has none.
std::optional<std::pair<double, double>> reference_of(const AxisRegression& axis, int column,
                                                      const model::Vehicle& vehicle) {
  for (const auto& known : vehicle.hydrodynamics->reference) {
    if (known.term == axis.candidates.terms[static_cast<std::size_t>(column)])
      return std::pair{known.value, known.error};
  }
  return std::nullopt;
}

std::string plus_minus(double value, double std) {
  return report::number(value) + " ± " + report::number(kNormal95 * std, 2);
}

std::string row_of(const AxisRegression& axis, const SelectedTerm& term, bool strongest,
                   const model::Vehicle& vehicle) {
  const auto known = reference_of(axis, term.column, vehicle);
  const double half = kNormal95 * term.total();
  std::vector<report::Whisker> bars{{term.value - half, term.value, term.value + half, report::kAfterColour}};
  double low = std::min(0.0, term.value - half), high = std::max(0.0, term.value + half);
  if (known) {
    const double spread = kNormal95 * known->second;
    bars.push_back({known->first - spread, known->first, known->first + spread, report::kMeasuredColour});
    low = std::min(low, known->first - spread);
    high = std::max(high, known->first + spread);
  }
  std::string as_well;
  for (const int column : term.equivalents) as_well += (as_well.empty() ? "" : ", ") + name_of(axis, column);
  const std::string name = escape(name_of(axis, term.column));
  return "<tr>" + cell(strongest ? "<b>" + name + "</b>" : name) + cell(plus_minus(term.value, term.total()), "n") +
         cell(known ? plus_minus(known->first, known->second) : "-", "n") +
         cell(report::whiskers(bars, low, high, 0.0)) + cell(term.beyond_errors() ? "larger" : "within them") +
         cell(escape(as_well)) + "</tr>\n";
}

std::string table_of(const AxisRegression& axis, const StepwiseResult& result, const model::Vehicle& vehicle) {
  if (result.terms.empty()) return "<p>No derivative is selected: none acts that these manoeuvres show.</p>\n";
  std::string html =
      "<table>" + report::heading_cells({"derivative", "found, 95 %", "reference", "found blue, reference dark",
                                         "and its errors", "would explain as much"},
                                        {1, 2});
  for (std::size_t i = 0; i < result.terms.size(); ++i)
    html += row_of(axis, result.terms[i], static_cast<int>(i) == result.most_significant, vehicle);
  return html + "</table>\n";
}

std::string quality_row(const std::string& name, const StepwiseResult& one) {
  return "<tr>" + cell(escape(name)) + cell(percent(one.explained), "n") + cell(percent(one.cross_validated), "n") +
         cell(plus_minus(one.phi, one.phi_sigma), "n") + cell(report::number(one.sigma, 2), "n") +
         cell(std::to_string(one.samples), "n") + cell(report::number(std::round(one.effective_samples)), "n") +
         "</tr>\n";
}

std::string quality_of(const AxisRegression& axis, std::span<const identification::ManoeuvreRows> runs) {
  std::string html =
      "<table>" + report::heading_cells({"manoeuvre", "explained", "of what was not fitted", "AR(1) of the residual",
                                         "its white part", "samples", "independent"},
                                        {1, 2, 3, 4, 5, 6});
  for (std::size_t i = 0; i < runs.size(); ++i) html += quality_row(runs[i].name, axis.manoeuvres[i]);
  if (runs.size() > 1) html += quality_row("together", axis.together);
  html += "</table>\n";
  std::string refused;
  for (const auto& one : axis.together.refused)
    refused += "<li>" + escape(name_of(axis, one.column)) + ": " + escape(one.why) + "</li>\n";
  return refused.empty() ? html : html + "<p>Not asked:</p><ul>" + refused + "</ul>\n";
}

std::string axis_section(const AxisRegression& axis, std::span<const identification::ManoeuvreRows> runs,
                         const model::Vehicle& vehicle) {
  const bool several = runs.size() > 1;
  const StepwiseResult& result = several ? axis.together : axis.manoeuvres.front();
  std::string html = std::string{"<section><h2>"} + letter(axis) + ", " + motion(axis) + "</h2>\n" +
                     table_of(axis, result, vehicle) +
                     "<details><summary>How well it explains, and what was not asked</summary>" +
                     quality_of(axis, runs) + "</details>\n";
  if (several) {
    html += "<details><summary>Each manoeuvre by itself</summary>";
    for (std::size_t i = 0; i < runs.size(); ++i)
      html += "<h3>" + escape(runs[i].name) + "</h3>" + table_of(axis, axis.manoeuvres[i], vehicle);
    html += "</details>\n";
  }
  return html + "</section>\n";
}

}  // namespace

std::string regress_page(const std::vector<AxisRegression>& axes, std::span<const identification::ManoeuvreRows> runs,
                         const model::Vehicle& vehicle, const identification::RegressionSettings& settings,
                         const std::string& more) {
  std::string names, tiles;
  for (const auto& run : runs) names += (names.empty() ? "" : ", ") + run.name;
  std::size_t selected = 0, stand = 0;
  for (const AxisRegression& axis : axes) {
    const StepwiseResult& result = runs.size() > 1 ? axis.together : axis.manoeuvres.front();
    selected += result.terms.size();
    stand += static_cast<std::size_t>(std::ranges::count_if(result.terms, &SelectedTerm::stands));
    tiles += report::tile(percent(result.cross_validated),
                          std::string{"of "} + motion(axis) + " explained where it was not fitted");
  }
  const std::string title = "Which derivatives act on " + vehicle.name;
  std::string html =
      report::page_head(title) + "<header><h1>" + escape(title) + "</h1>\n<p class=\"soft\">Stepwise regression of " +
      escape(names) + "; forces from " + escape(runs.empty() ? "" : runs.front().known_from) +
      ".</p>\n<div class=\"badge " + (stand > 0 ? "adequate" : "unexplained") + "\">" + std::to_string(stand) + " of " +
      std::to_string(selected) +
      " selected derivatives stand</div>\n<p class=\"lead\">Those that stand are larger than their "
      "errors, at 95 %, and no other term would explain as much. Dimensionless; intervals hold what the "
      "residual scatters, what instruments and reconstruction may be off by, and terms that act and were "
      "not selected.</p>\n"
      "<div class=\"tiles\">" +
      tiles + "</div>\n";
  if (!settings.v_WF.isZero(0.0))
    html += "<p>The water moves north " + report::number(settings.v_WF.x()) + ", east " +
            report::number(settings.v_WF.y()) + " m/s.</p>\n";
  html +=
      "<p class=\"note\"><b>Next.</b> fathom regress ... --write COEFFICIENTS.yaml keeps them; fathom compare flies "
      "them beside "
      "other sets.</p></header>\n";
  for (const AxisRegression& axis : axes) html += axis_section(axis, runs, vehicle);
  return html + more + report::version_line() + "</main></body></html>\n";
}

}  // namespace fathom::tool

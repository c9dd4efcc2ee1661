// Sections of the report page that are mostly pictures: errors, motion, leftover forces and their memory.
#include <algorithm>
#include <cmath>

#include "common/report/live_plot.hpp"
#include "common/report/page_parts.hpp"
#include "common/report/pictures.hpp"
#include "common/report/series.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr std::size_t kMostPoints = 1200;    // per curve: one per pixel of a wide screen is plenty
constexpr std::size_t kPointBudget = 60000;  // of all curves together: keeps the page small with many runs
constexpr std::size_t kMostNumbers = 60000;  // of all plots that can be looked into: some 200 kB
constexpr double kCloseUp = 60.0;            // s: six windows of 10 s
constexpr std::size_t kDependenceBins = 10;

const PredictionError* at_horizon(const ModelError& error, double horizon) {
  const auto found = std::ranges::find(error.prediction, horizon, &PredictionError::horizon_s);
  return found == error.prediction.end() ? nullptr : &*found;
}

std::vector<double> horizons(const DiagnosisResult& result) {
  std::vector<double> all;
  for (const auto* error : {&result.error_before, &result.error_after}) {
    for (const auto& p : error->prediction) all.push_back(p.horizon_s);
  }
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::string pair(const std::string& before, const std::string& after) {
  return cell("<span class=\"b\">" + escape(before) + "</span>", "n") +
         cell("<span class=\"a\">" + escape(after) + "</span>", "n");
}

std::string error_table(const DiagnosisResult& result) {
  std::string html = "<table class=\"errors\"><tr><th></th>";
  std::string second = "<tr><th>Axis</th>";
  for (const double h : horizons(result)) {
    html += "<th class=\"group\" colspan=\"4\">" + escape(plain(h)) + " s ahead</th>";
    second += "<th class=\"n\" colspan=\"2\">rms error</th><th class=\"n\" colspan=\"2\">R²</th>";
  }
  html += "</tr>\n" + second + "</tr>\n";
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    if (!predicted(result, axis)) continue;
    html += "<tr>" + cell(escape(velocity_label(kAxes[axis])), "k");
    for (const double h : horizons(result)) {
      const PredictionError* before = at_horizon(result.error_before, h);
      const PredictionError* after = at_horizon(result.error_after, h);
      const auto rmse = [&](const PredictionError* e) {
        return e ? number(kAxes[axis].scale * e->rmse[axis]) : std::string("-");
      };
      const auto r2 = [&](const PredictionError* e) { return e ? r_squared(e->r2[axis]) : std::string("-"); };
      html += pair(rmse(before), rmse(after)) + pair(r2(before), r2(after));
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

bool drawable(const PredictionTrace& trace, std::size_t axis) {
  const std::size_t size = trace.t.size();
  if (size < 2 || trace.measured.size() != size) return false;
  const auto finite = [&](const auto& row) { return std::isfinite(row[axis]); };
  return std::ranges::any_of(trace.before, finite) || std::ranges::any_of(trace.after, finite);
}

// Without decimals: "0 %" for a little.
std::string whole_percent(double share) { return plain(std::round(100.0 * share)) + " %"; }

// White to the given colour; the number on it stays readable.
std::string shade(double share, const char* rgb) {
  if (!std::isfinite(share)) return "<span>-</span>";
  return "<span style=\"background:rgba(" + std::string(rgb) + "," + number(0.06 + 0.64 * std::sqrt(share), 2) +
         ")\">" + escape(whole_percent(share)) + "</span>";
}

struct AxisStudy {
  std::size_t axis{};
  Leftover left;
  std::vector<Quantity> against;
  std::vector<double> follows_before;
  std::vector<double> follows_after;
  double worst{};  ///< largest share after
};

std::vector<AxisStudy> studies(const DiagnosisReport& report) {
  std::vector<AxisStudy> all;
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    auto left = leftover(report.traces, axis);
    if (!left) continue;
    AxisStudy study{axis, std::move(*left), quantities(report.traces, axis), {}, {}, 0.0};
    const Memory m = memory(report.traces, axis);
    const double share_before = independent_share(m, m.before);
    const double share_after = independent_share(m, m.after);
    for (const Quantity& q : study.against) {
      study.follows_before.push_back(dependence(q.values, study.left.before, kDependenceBins, share_before));
      study.follows_after.push_back(dependence(q.values, study.left.after, kDependenceBins, share_after));
      if (study.follows_after.back() > study.worst) study.worst = study.follows_after.back();
    }
    all.push_back(std::move(study));
  }
  return all;
}

std::string overview(const std::vector<AxisStudy>& all) {
  constexpr const char* kNames[] = {"time",      "north",       "east",   "depth",  "heading",
                                    "own speed", "total speed", "thrust", "voltage"};
  std::string html = "<table><tr><th>Leftover in</th>";
  std::vector<std::string> shown;
  for (const char* name : kNames) {
    const bool any = std::ranges::any_of(all, [&](const AxisStudy& s) {
      return std::ranges::find(s.against, std::string(name), &Quantity::name) != s.against.end();
    });
    if (!any) continue;
    shown.emplace_back(name);
    html += "<th>" + escape(name) + "</th>";
  }
  html += "</tr>\n";
  for (const AxisStudy& s : all) {
    html += "<tr>" + cell(escape(kAxes[s.axis].name), "k");
    for (const auto& name : shown) {
      const auto at = static_cast<std::size_t>(std::ranges::find(s.against, name, &Quantity::name) - s.against.begin());
      html += at == s.against.size() ? cell("")
                                     : cell("<div class=\"two\">" + shade(s.follows_before[at], "224,123,0") +
                                            shade(s.follows_after[at], "10,94,168") + "</div>");
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

}  // namespace

std::string error_section(const DiagnosisResult& result, Album& album) {
  std::string html = "<section><h2>How far off the prediction is, before and after</h2>\n";
  if (horizons(result).empty()) return html + "<p>No prediction error was computed.</p></section>\n";
  html +=
      "<p>The model starts from the measured motion and then runs on thruster commands alone. The bars show how far it "
      "is off after 1, 5 and 10 s (root mean square over the validation runs): shorter is better.</p>\n<div "
      "class=\"grid four\">";
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    if (predicted(result, axis)) html += "<figure>" + album.place(draw_errors(result, axis)) + "</figure>";
  }
  html += "</div>\n" + error_table(result);
  if (const std::string words = how_far(result.foretold); !words.empty()) html += "<p>" + words + "</p>\n";
  html +=
      "<p class=\"small soft\">R² says how much of the motion is predicted: 1 is all of it, 0 is no better than "
      "assuming the "
      "average, below 0 is worse than that.</p>\n";
  std::string forces;
  for (const Axis& a : kAxes) {
    const auto before = result.error_before.force_rmse.find(a.force);
    const auto after = result.error_after.force_rmse.find(a.force);
    const bool has_before = before != result.error_before.force_rmse.end() && std::isfinite(before->second);
    const bool has_after = after != result.error_after.force_rmse.end() && std::isfinite(after->second);
    if (!has_before && !has_after) continue;
    forces += std::string(forces.empty() ? "" : "; ") + escape(force_label(a)) + " <span class=\"b\">" +
              (has_before ? number(before->second) : "-") + "</span> → <span class=\"a\">" +
              (has_after ? number(after->second) : "-") + "</span>";
  }
  if (!forces.empty()) html += "<p class=\"small\">Force that the model does not explain (rms): " + forces + ".</p>\n";
  return html + "</section>\n";
}

std::string motion_section(const DiagnosisReport& report, Album& album) {
  std::size_t curves = 0, numbers = 0;
  for (const auto& trace : report.traces) {
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      curves += drawable(trace, axis) ? 6 : 0;
      numbers += drawable(trace, axis) ? 4 * trace.t.size() : 0;
    }
  }
  const std::size_t every = (numbers + kMostNumbers - 1) / kMostNumbers;
  if (curves == 0) return "";
  const std::size_t points = std::clamp<std::size_t>(kPointBudget / curves, 150, kMostPoints);
  std::string html =
      "<section><h2>Measured against simulated motion</h2>\n<p>Each light vertical line is a fresh start: there the "
      "simulation "
      "takes the measured motion and then runs on thruster commands alone until the next line. The closer the coloured "
      "curves "
      "stay to the dark one, the better the model. A curve that leaves the frame is cut at its edge. Drag over a "
      "stretch to look closer; all axes of a run follow. The "
      "close-up is a "
      "typical stretch: half of the others are predicted better by the base model, half worse.</p>\n";
  for (const auto& trace : report.traces) {
    std::string pictures;
    const auto close_up = typical_stretch(trace, kCloseUp);
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      if (!drawable(trace, axis)) continue;
      pictures += "<figure>" +
                  live_plot(album.place(draw_motion(trace, axis, points)), live_motion(trace, axis), every) +
                  "</figure>\n";
      if (close_up) pictures += "<figure>" + album.place(draw_motion(trace, axis, points, close_up)) + "</figure>\n";
    }
    if (!pictures.empty())
      html += "<h3>Run " + escape(trace.run) + "</h3>\n<div class=\"grid" + " pair" + "\">" + pictures + "</div>\n";
  }
  return html + "</section>\n";
}

std::string leftover_section(const DiagnosisReport& report, Album& album) {
  const auto all = studies(report);
  if (all.empty()) return "";
  std::string html =
      "<section><h2>What the leftover force follows</h2>\n<p>The leftover is the force (or moment) that acted but that "
      "the model "
      "does not explain. If it follows some quantity, the model lacks something that depends on it. Each cell: share "
      "of the "
      "leftover that follows the quantity, beyond chance, <span class=\"b\">before</span> and <span "
      "class=\"a\">after</span>. "
      "Stronger colour: more is still hidden there; a dash: too little data to say.</p>\n" +
      overview(all) +
      "<p>Below, axis by axis: dots are samples, the line joins the medians of ten groups, the vertical bars span the "
      "middle "
      "half. A flat line on zero is what a complete model leaves.</p>\n";
  const auto worst = std::ranges::max_element(all, {}, &AxisStudy::worst);
  for (const AxisStudy& s : all) {
    html += std::string("<details") + (s.axis == worst->axis ? " open>" : ">") + "<summary>" +
            escape(force_label(kAxes[s.axis])) + "</summary><div class=\"grid\">";
    for (const Quantity& q : s.against)
      html += "<figure>" + album.place(draw_dependence(s.left, q, s.axis)) + "</figure>";
    html += "</div></details>\n";
  }
  return html + "</section>\n";
}

std::string memory_section(const DiagnosisReport& report, Album& album) {
  const DiagnosisResult& result = report.result;
  std::string pictures;
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    if (!leftover(report.traces, axis)) continue;
    const Memory m = memory(report.traces, axis);
    if (m.lag.size() > 2) pictures += "<figure>" + album.place(draw_memory(m, axis)) + "</figure>";
  }
  std::string rows;
  for (const Axis& a : kAxes) {
    const auto of = [&](const std::vector<AxisWhiteness>& axes) -> const AxisWhiteness* {
      const auto found = std::ranges::find(axes, std::string(a.force), &AxisWhiteness::axis);
      return found == axes.end() ? nullptr : &*found;
    };
    const AxisWhiteness* before = of(result.residual_before);
    const AxisWhiteness* after = of(result.residual_after);
    if (before == nullptr && after == nullptr) continue;
    const auto both = [&](auto text) { return pair(before ? text(*before) : "-", after ? text(*after) : "-"); };
    rows +=
        "<tr>" + cell(escape(force_label(a)), "k") + both([](const AxisWhiteness& w) { return percent(w.explained); }) +
        both([](const AxisWhiteness& w) { return number(w.autocorrelation_time_s, 2) + " s"; }) +
        both([](const AxisWhiteness& w) { return w.p_value < 1e-4 ? std::string("< 0.0001") : number(w.p_value, 2); }) +
        "</tr>\n";
  }
  if (pictures.empty() && rows.empty()) return "";
  std::string html =
      "<section><h2>Does the leftover remember itself?</h2>\n<p>How alike the leftover is to itself some time later "
      "(1: the same, "
      "0: unrelated). Pure noise drops into the grey band (95 %) at once; a slow decline or a swing means that some "
      "physics is "
      "still missing.</p>\n<div class=\"grid\">" +
      pictures + "</div>\n";
  if (!rows.empty()) {
    html +=
        "<table><tr><th></th><th class=\"n\" colspan=\"2\">applied force explained</th><th class=\"n\" "
        "colspan=\"2\">remembers "
        "itself for</th><th class=\"n\" colspan=\"2\">chance that it is pure noise</th></tr>\n" +
        rows + "</table>\n";
  }
  return html + "</section>\n";
}

}  // namespace fathom::report

// The page of a live trial: first what came of it, what was flown and the vehicle's numbers; folded, the motion and how
// the numbers settled; last and apart, what the truth says. The figures of the paper (Karras et al.) are named small
// beside.
#include <algorithm>
#include <cmath>

#include "common/model/parameters.hpp"
#include "common/report/contact_sheet.hpp"
#include "common/report/filter_figures.hpp"
#include "common/report/live/live_figures.hpp"
#include "common/report/live/live_trial.hpp"
#include "common/report/page_parts.hpp"
#include "common/report/pictures.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr const char* kTagColour = "#e07b00";
constexpr const char* kLaserColour = "#2a9d4b";

std::string key(const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string html = "<p class=\"small soft\">";
  for (const auto& [colour, words] : entries) {
    html += "<span style=\"color:" + colour + ";font-weight:700\">●</span> " + escape(words) + " &nbsp; ";
  }
  return html + "</p>\n";
}

/// "Where it was", and small beside it the paper's figure that it is.
std::string heading(const std::string& title, const std::string& paper) {
  return "<section><h2>" + title + " <span class=\"paper\">" + paper + "</span></h2>";
}

/// A line per motion that is not settled, per effect that is suspected, per process that was not well.
std::string findings(const LiveTrialResult& result) {
  std::string items;
  for (auto visit = result.visits.begin(); visit != result.visits.end(); ++visit) {
    const auto same = [&](const ModeVisit& other) { return other.mode == visit->mode; };
    // What the last visit of a motion says is what counts; one that had only begun says nothing.
    const bool later = std::any_of(visit + 1, result.visits.end(), [&](const ModeVisit& other) {
      return same(other) && (other.left || !other.missing.empty());
    });
    const bool begun = visit->missing.empty() && std::any_of(result.visits.begin(), visit, same);
    if (visit->left || later || begun) continue;
    items += "<li><b>Not settled: " + escape(visit->mode) + "</b>" +
             (visit->missing.empty() ? std::string{}
                                     : " <span class=\"soft\">missing: " + escape(visit->missing) + "</span>") +
             "</li>\n";
  }
  const bool named = result.ranking.verdict == "effect" || result.ranking.verdict == "ambiguous";
  for (const EffectEvidence& one : result.ranking.candidates) {
    if (!named || !(one.log_odds > 0.0)) continue;
    const bool adopted = std::ranges::find(result.adopted, one.name) != result.adopted.end();
    items += "<li>Missing in the base model: <b>" + escape(effect_title(one.name, one.variant)) +
             "</b> <span class=\"soft\">" + escape(odds(one.log_odds)) + "; " +
             escape(adopted ? "in the identifier's model" : "not in the identifier's model") + "</span></li>\n";
  }
  for (const auto& [process, words] : result.complaints)
    items += "<li>" + escape(process) + " said: " + escape(words) + "</li>\n";
  return items.empty() ? "" : "<ul class=\"causes\">" + items + "</ul>\n";
}

std::string next(const LiveTrialResult& result) {
  if (!result.ranking.segment.empty())
    return "Fly '" + result.ranking.segment + "': it tells " + effect_title(result.ranking.candidates.front().name) +
           " from " + effect_title(result.ranking.against) + ".";
  if (!result.settled() && result.phase != "recorded")
    return "Fly on until every motion is settled: what is missing stands above.";
  return result.afterwards ? std::string{}
                           : "Have the log diagnosed: fathom diagnose --vehicle V.yaml --train RUN.lcmlog --out DIR.";
}

std::string outcome(const LiveTrialResult& result, const Recording& recording, const estimation::AidsSeen& seen,
                    Album& album) {
  const bool settled = result.settled();
  std::string words = "The trial was not finished";
  if (result.phase == "done") words = settled ? "All modes are settled" : "Finished, but not everything is settled";
  if (result.phase == "aborted") words = "The trial was aborted";
  if (result.phase == "lost") words = "The state was lost";
  if (result.phase == "recorded") words = "A recorded run, flown without a supervisor";
  if (!result.failing.empty()) words += "; the model lacks something on " + join(result.failing, ", ");
  const auto left = std::ranges::count_if(result.visits, [](const ModeVisit& visit) { return visit.left; });
  std::string html = "<header><h1>" + escape(trial_title(result)) +
                     "</h1>\n<p class=\"soft\">Site: " + escape(result.site) + "</p>\n<div class=\"badge " +
                     (settled && result.failing.empty() ? "adequate"
                      : result.phase == "recorded"      ? "other"
                                                        : "ambiguous") +
                     "\">" + escape(words) + "</div>\n<p class=\"lead\">" + escape(result.reason) + "</p>\n" +
                     findings(result) + "<div class=\"tiles\">";
  html += tile(number(result.seconds, 4) + " s", "from the first state to the last");
  if (!result.visits.empty())
    html += tile(std::to_string(left) + " of " + std::to_string(result.visits.size()), "modes settled");
  if (!result.parameters.empty())
    html += tile(std::to_string(result.parameters.size()), "parameters identified on line");
  if (!result.ranking.verdict.empty() || !result.visits.empty())
    html += tile(result.ranking.verdict.empty() ? "-" : result.ranking.verdict,
                 "the diagnoser's verdict; in the model: " +
                     (result.adopted.empty() ? std::string{"no effect"} : join(result.adopted, ", ")));
  const bool deep = seen.tags.t.empty();
  const std::array place{AidCurve{deep ? &seen.usbl : &seen.tags, kTagColour}};
  html += "</div>\n<div class=\"grid pair\">" +
          figure(album.place(draw_plan(recording, place)), "The path from above.") +
          figure(album.place(draw_path(recording)), "The path in space. <span class=\"paper\">Figure 1.14</span>") +
          "</div>";
  if (const std::string words_of_next = next(result); !words_of_next.empty())
    html += "<p class=\"note\"><b>Next.</b> " + escape(words_of_next) + "</p>\n";
  return html + "</header>\n";
}

std::string mode_table(const LiveTrialResult& result) {
  if (result.visits.empty() && result.flights.empty()) return "";
  std::string html = "<section><h2>What was flown</h2><table>" +
                     heading_cells({"Mode", "From [s]", "To [s]", "Metric", "Threshold", "Outcome"}, {1, 2, 3, 4});
  for (const ModeVisit& visit : result.visits) {
    html += "<tr>" + cell(escape(visit.mode), "k") + cell(number(visit.begun, 4), "n") +
            cell(number(visit.ended, 4), "n") + cell(visit.metric < 0.0 ? "-" : number(visit.metric), "n") +
            cell(number(visit.threshold), "n") +
            cell(visit.left ? "settled" : "not settled; missing: " + escape(visit.missing)) + "</tr>\n";
  }
  for (const FlownSegment& flight : result.flights) {
    html += "<tr>" + cell(kSegmentMode, "k") + cell(number(flight.begun, 4), "n") + cell(number(flight.ended, 4), "n") +
            cell("-", "n") + cell("-", "n") + cell("flown: " + escape(flight.segment)) + "</tr>\n";
  }
  return html +
         "</table><p class=\"small soft\">A mode is left when the sum of its parameters' variances is below the "
         "threshold, and the residual and the numbers themselves agree.</p></section>\n";
}

std::string table_1_1(const LiveTrialResult& result) {
  if (result.parameters.empty()) return "";
  std::string html =
      heading("The vehicle's numbers", "Table 1.1") + "<p>Numbers of the <b>" + escape(estimate_words(result)) +
      "</b>. <b>" + escape(doubt_words(result)) + "</b></p><table>" +
      heading_cells({"Parameter", "Identified", "Std", "95 % interval", "Unit", "Vehicle file", "Entangled"},
                    {1, 2, 3, 5, 6});
  const std::vector<double>& inflation = result.entangled.inflation;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const NamedValue& p = result.parameters[i];
    const auto known = std::ranges::find(result.expected, p.name, &NamedValue::name);
    html += "<tr>" + cell(escape(p.name), "k") + cell(number(p.value, 4), "n") + cell(number(p.std, 2), "n") +
            cell(number(p.value - kNormal95 * p.std, 4) + " to " + number(p.value + kNormal95 * p.std, 4), "n") +
            cell(escape(p.unit)) + cell(known == result.expected.end() ? "-" : number(known->value, 4), "n") +
            cell(i < inflation.size() ? number(inflation[i], 3) : "-", "n") + "</tr>\n";
  }
  for (const NamedValue& p : result.effect_numbers) {
    html += "<tr class=\"yes\">" + cell(escape(p.name), "k") + cell(number(p.value, 4), "n") +
            cell(number(p.std, 2), "n") +
            cell(number(p.value - kNormal95 * p.std, 4) + " to " + number(p.value + kNormal95 * p.std, 4), "n") +
            cell(escape(p.unit)) + cell("adopted effect") + cell("") + "</tr>\n";
  }
  return html +
         "</table><p class=\"small soft\">Vehicle file: what it states beforehand; for the LBV150 the paper's "
         "Table 1.1. Entangled: how many times the variance is what it would be, were all other parameters known; 1 "
         "is best. Condition of all correlations: " +
         (inflation.empty() ? std::string{"-"} : number(result.entangled.condition, 3)) + ".</p></section>\n";
}

std::string filter_section(const estimation::NavigatorSettings& settings, const estimation::AidsSeen& seen,
                           Album& album) {
  std::string html;
  for (const bool second : {false, true}) {
    std::vector<DrawnFilter> drawn = filters_of(settings, seen);
    std::erase_if(drawn, [&](const DrawnFilter& filter) { return filter.second_order != second; });
    if (drawn.empty()) continue;
    std::vector<std::pair<std::string, std::string>> entries;
    entries.reserve(drawn.size());
    for (const DrawnFilter& filter : drawn) {
      entries.emplace_back(filter.published ? kBeforeColour : kAfterColour,
                           filter.words + " every " + number(1e3 * filter.interval, 3) + " ms: k_p " +
                               number(filter.gains.value, 3) +
                               (second ? ", k_b " + number(filter.gains.rate, 3) + " per s" : std::string{}));
    }
    html += heading(second ? "What the filter lets through: velocity, second order"
                           : "What the filter lets through: horizontal position, first order",
                    second ? "Figure 1.5" : "Figure 1.4") +
            key(entries) + "<p class=\"small soft\">Solid: what passes of the measurement; dashed: of the integrated " +
            (second ? "acceleration" : "velocity") + ". Gains as the filter had them, at the median interval.</p>" +
            "<div class=\"grid pair\">" + figure(album.place(draw_bode(drawn, BodePart::kMagnitude)), "") +
            figure(album.place(draw_bode(drawn, BodePart::kPhase)), "") + "</div></section>\n";
  }
  return html;
}

std::string motion(const Recording& recording, const estimation::AidsSeen& seen, Album& album) {
  const bool deep = seen.tags.t.empty();
  const AidCurve place{deep ? &seen.usbl : &seen.tags, kTagColour};
  const AidCurve speed{deep ? &seen.dvl : &seen.flow, kTagColour};
  const AidCurve height{deep ? &seen.depth : &seen.laser, kLaserColour};
  const std::string place_name = deep ? "acoustic fixes (USBL)" : "markers alone";
  const std::string speed_name = deep ? "velocity log alone" : "optical flow alone";
  const auto put = [&](Figure drawn) { return figure(album.place(std::move(drawn)), ""); };
  const std::array only_place{place}, only_speed{speed};
  const std::array both = deep ? std::array{height, height} : std::array{place, height};
  std::string html = heading("Where it was", "Figure 1.11") +
                     key({{kTagColour, place_name}, {kMeasuredColour, "estimate"}}) + "<div class=\"grid pair\">" +
                     put(draw_component(recording, 0, only_place)) + put(draw_component(recording, 1, only_place)) +
                     "</div></section>\n";
  html += heading("How fast it went", "Figure 1.12") + key({{kTagColour, speed_name}, {kMeasuredColour, "estimate"}}) +
          "<div class=\"grid pair\">" + put(draw_component(recording, 3, only_speed)) +
          put(draw_component(recording, 4, only_speed)) + "</div></section>\n";
  html += heading("Depth and heave", "Figure 1.13") +
          key({{kLaserColour, deep ? "depth sensor alone" : "laser alone"},
               {kTagColour,
                deep ? "velocity log alone" : place_name + "; heave: optical flow alone, by the picture's growth"},
               {kMeasuredColour, "estimate"}}) +
          "<div class=\"grid pair\">" + put(draw_component(recording, 2, both)) +
          put(draw_component(recording, 5, only_speed)) + "</div></section>\n";
  return html;
}

std::vector<std::string> of_axes(const LiveTrialResult& result, std::initializer_list<int> axes) {
  std::vector<std::string> names;
  for (const int axis : axes) {
    for (const NamedValue& p : result.parameters) {
      const auto parameter = model::parameter_from_name(p.name);
      if (parameter && model::axis(*parameter) == axis) names.push_back(p.name);
    }
  }
  return names;
}

std::string evolution(const Recording& recording, const LiveTrialResult& result, Album& album) {
  double total_begins = result.seconds, total_ends = result.seconds;
  bool has_total = false;
  for (const ModeVisit& visit : result.visits) {
    if (visit.mode != "total") continue;
    has_total = true;
    total_begins = visit.begun;
    total_ends = visit.ended;
  }
  const auto section = [&](const std::string& title, const std::string& paper, const std::vector<std::string>& names,
                           double begin, double end) {
    if (names.empty() || !(end > begin)) return std::string{};
    std::string html = heading(title, paper) + "<div class=\"grid\">";
    for (const std::string& name : names) {
      html += figure(album.place(draw_parameter(recording, result.visits, name, begin, end)), "");
    }
    return html + "</div></section>\n";
  };
  const auto surge_sway = of_axes(result, {0, 1}), heave_yaw = of_axes(result, {2, 5}), tilt = of_axes(result, {3, 4});
  // Designed segments begin with all axes at once.
  const bool has_own = std::ranges::any_of(result.visits, [](const ModeVisit& visit) { return visit.mode != "total"; });
  const double modes_end = !has_total ? result.seconds : has_own ? total_begins : 0.0;
  std::string html = section("How the numbers of surge and sway settled, in modes of their own", "Figure 1.15",
                             surge_sway, 0.0, modes_end) +
                     section("How the numbers of heave and yaw settled, in modes of their own", "Figure 1.16",
                             heave_yaw, 0.0, modes_end) +
                     section("How the numbers of roll and pitch settled", "", tilt, 0.0, result.seconds);
  if (has_total) {
    html += section("How the numbers of surge and sway settled, all motions at once", "Figure 1.17", surge_sway,
                    total_begins, total_ends) +
            section("How the numbers of heave and yaw settled, all motions at once", "Figure 1.18", heave_yaw,
                    total_begins, total_ends);
  }
  if (result.visits.empty()) return html;
  html += heading("When each motion was sure", "Figure 1.19") +
          "<p class=\"small soft\">Sum of the variances of a mode's parameters "
          "(eq. 1.15) against its threshold (dashed); shaded: the mode itself.</p><div class=\"grid\">";
  std::vector<std::string> drawn;
  for (const ModeVisit& visit : result.visits) {
    if (std::ranges::find(drawn, visit.mode) != drawn.end()) continue;
    drawn.push_back(visit.mode);
    const bool known = std::ranges::any_of(recording.model, [&](const ModelEstimate& model) {
      return std::ranges::any_of(model.modes, [&](const ModeMetric& m) { return m.mode == visit.mode && m.sum > 0.0; });
    });
    if (!known) continue;  // a trial that was cut before the identifier said anything of this mode
    html += figure(album.place(draw_metric(recording, result, visit.mode)), "");
  }
  return html + "</div></section>\n";
}

std::string suspects(const LiveTrialResult& result) {
  if (result.ranking.candidates.empty() && !result.learned) return "";
  std::string html = "<section><h2>What the diagnoser said while it ran</h2><p>Verdict: <b>" +
                     escape(result.ranking.verdict) + "</b></p>";
  if (result.learned) {
    const LearnedTold& learned = *result.learned;
    html += "<p><b>" + std::string{learned.adopted ? "Learned" : "Not learned"} + ".</b> " + escape(learned.words) +
            (learned.equation.empty() ? "" : " <code>" + escape(learned.equation) + "</code>") + "</p>";
  }
  html += "<table>" + heading_cells({"Candidate", "Log odds", "Explains", ""}, {1, 2});
  for (const EffectEvidence& one : result.ranking.candidates) {
    const bool adopted = std::ranges::find(result.adopted, one.name) != result.adopted.end();
    html += std::string{adopted ? "<tr class=\"yes\">" : "<tr>"} + cell(escape(effect_title(one.name)), "k") +
            cell(number(one.log_odds), "n") + cell(percent(one.error_reduction), "n") +
            cell(adopted ? "<span class=\"mark\">in the model</span>" : "") + "</tr>\n";
  }
  return html + "</table></section>\n";
}

std::string truth_section(const LiveTrialResult& result, const Recording& recording, Album& album) {
  const TruthComparison& truth = *result.truth;
  std::string html =
      "<section style=\"border:3px double #9c2f5c\"><h2>Compared with the simulator's truth</h2>"
      "<p class=\"note\">None of the processes heard what stands here: the simulator wrote it for this page alone.</p>"
      "<p>Hidden: " +
      escape(truth.effects.empty() ? "no effect" : join(truth.effects, "; ")) + ". Contacts: walls " +
      std::to_string(truth.contacts[0]) + ", floor " + std::to_string(truth.contacts[1]) + ", surface " +
      std::to_string(truth.contacts[2]) + ".</p><table>" +
      heading_cells({"Parameter", "Identified", "Std", "Truth", "Error", "Error", "Truth in the 95 % interval"},
                    {1, 2, 3, 4, 5});
  for (const NamedValue& p : result.parameters) {
    const auto found = truth.parameters.find(p.name);
    if (found == truth.parameters.end()) continue;
    const double error = p.value - found->second;
    const bool inside = std::abs(error) <= kNormal95 * p.std;
    html += "<tr>" + cell(escape(p.name), "k") + cell(number(p.value, 4), "n") + cell(number(p.std, 2), "n") +
            cell(number(found->second, 4), "n") + cell(number(error, 2), "n") +
            cell(number(100.0 * error / std::abs(found->second), 2) + " %", "n") + cell(inside ? "yes" : "<b>no</b>") +
            "</tr>\n";
  }
  html += "</table>\n";
  if (truth.compared > 0) {
    html += "<h3>Errors of the estimated motion</h3>" +
            key({{kMeasuredColour, "estimate minus truth"}, {kBeforeColour, "two standard deviations as stated"}}) +
            "<div class=\"grid\">";
    for (std::size_t axis = 0; axis < 6; ++axis) {
      html += figure(album.place(draw_state_error(recording, axis)),
                     "rms " + number(1e3 * truth.state_rms[axis], 2) + ", largest " +
                         number(1e3 * truth.state_worst[axis], 2) + (axis < 3 ? " mm" : " mm/s") +
                         "; mean square over the stated one " + number(truth.state_normalised[axis], 2));
    }
    html += "</div>";
  }
  return html + "</section>\n";
}

/// Sections one after the other, each folded.
std::string each_folded(const std::string& sections) {
  constexpr std::string_view kEnd = "</section>\n";
  std::string html;
  for (std::size_t begin = 0; begin < sections.size();) {
    const std::size_t end = sections.find(kEnd, begin);
    if (end == std::string::npos) return html + sections.substr(begin);
    html += folded(sections.substr(begin, end + kEnd.size() - begin));
    begin = end + kEnd.size();
  }
  return html;
}

}  // namespace

std::string to_html(const LiveTrialResult& result, const Recording& recording, const model::Vehicle& vehicle,
                    const model::Site& site, std::span<const Camera> pictures,
                    const estimation::NavigatorSettings* filters, const std::string& gnuplot) {
  Album album;
  const estimation::AidsSeen seen = estimation::aids_seen(recording, vehicle.mounts, site, trial_origin(recording));
  std::string page = page_head(trial_title(result));
  page += outcome(result, recording, seen, album) + mode_table(result) + table_1_1(result);
  if (result.afterwards) page += afterwards_section(*result.afterwards);
  page += each_folded(suspects(result) + motion(recording, seen, album));
  page += contact_sheet(pictures, trial_origin(recording));
  page += each_folded(evolution(recording, result, album));
  if (filters != nullptr) page += each_folded(filter_section(*filters, seen, album));
  if (result.truth) page += truth_section(result, recording, album);
  return album.fill(page + version_line() + "</main></body></html>\n", gnuplot);
}

}  // namespace fathom::report

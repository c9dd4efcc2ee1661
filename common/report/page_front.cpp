// The first screen of the report: what it comes to, one line per cause, the error before and after, the picture that
// shows it, and what to do next.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "common/model/effect.hpp"
#include "common/model/parameters.hpp"
#include "common/report/correction.hpp"
#include "common/report/finding.hpp"
#include "common/report/live_plot.hpp"
#include "common/report/page_parts.hpp"
#include "common/report/pictures.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr double kHorizon = 5.0;           // s
constexpr double kCloseUp = 60.0;          // s: six windows of 10 s
constexpr std::size_t kMostPoints = 1200;  // one per pixel of a wide screen is plenty

/// What every craft of its kind has, and the base model has not: no fault, and nothing to look for.
bool of_own_flow(const EffectFound& effect) {
  const model::Effect* known = model::find_effect(effect.name);
  return known != nullptr && known->traits().own_flow;
}

struct Meaning {
  std::string css;
  std::string words;
};

Meaning meaning(const std::string& verdict, bool wiring) {
  if (wiring) return {"unexplained", "The vehicle's file seems to have other thrusters than the vehicle"};
  if (verdict == "adequate") return {"adequate", "The model is adequate: nothing is missing that this data can show"};
  if (verdict == "effect") return {"effect", "Something was missing, and it was found"};
  if (verdict == "unexplained") return {"unexplained", "Something is missing, and none of the known causes fits"};
  if (verdict == "no_model")
    return {"unexplained", "The model does not follow its thrust: numbers of such axes are withheld"};
  if (verdict == "unjudged" || verdict == "not_judged") return {"ambiguous", "These runs show too little to judge by"};
  return {"other", verdict.empty() ? "No verdict" : "Verdict: " + verdict};
}

/// What the craft lacks and what its sensors say, of causes that are claimed.
bool claimed(const EffectFound& effect) { return effect.accepted && !of_own_flow(effect); }

/// Of several causes some may be sure, and of one that stands alone it is its evidence that is weak.
std::string in_doubt(const DiagnosisResult& result) {
  constexpr double kSure = 0.9;  // as inference::Thresholds::name_probability, which this room does not see
  std::size_t sure = 0, doubtful = 0, shared = 0;
  for (const EffectFound& effect : result.effects) {
    if (!claimed(effect)) continue;
    const bool weak = effect.probability < kSure;
    ++(weak ? doubtful : sure);
    if (weak && !effect.alternatives.empty()) ++shared;
  }
  if (doubtful == 0) return "Something is missing, but this data fits several causes";
  if (sure == 0)
    return shared > 0 ? "Something is missing, but this data fits several causes"
                      : "Something is missing, and the evidence for its cause is weak";
  return "Something was missing: " + std::to_string(sure) + (sure == 1 ? " cause is" : " causes are") +
         " found, and of " + std::to_string(doubtful) + " more this data is not sure";
}

/// Both parts of a divided run are one.
std::string recordings(const DiagnosisResult& result) {
  std::set<std::string> runs;
  for (const auto* names : {&result.train, &result.validate}) {
    for (const std::string& name : *names) runs.insert(name.substr(0, name.find(" (")));
  }
  return std::to_string(runs.size()) + (runs.size() == 1 ? " recorded run" : " recorded runs");
}

std::string lines(const std::string& text) {
  std::string html;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end > begin) html += "<p>" + escape(text.substr(begin, end - begin)) + "</p>\n";
    begin = end + 1;
  }
  return html;
}

const PredictionError* at_horizon(const ModelError& error) {
  const auto found = std::ranges::find(error.prediction, kHorizon, &PredictionError::horizon_s);
  return found == error.prediction.end() ? nullptr : &*found;
}

/// The axis whose prediction has changed most, by the ratio of its errors; none where nothing was predicted.
std::optional<std::size_t> telling_axis(const DiagnosisResult& result) {
  const PredictionError *before = at_horizon(result.error_before), *after = at_horizon(result.error_after);
  std::optional<std::size_t> best;
  double most = -1.0;
  for (std::size_t axis = 0; before != nullptr && after != nullptr && axis < kAxes.size(); ++axis) {
    const double change = std::abs(std::log(after->rmse[axis] / before->rmse[axis]));
    if (!std::isfinite(change) || change <= most) continue;
    most = change;
    best = axis;
  }
  return best;
}

/// Symbols stay as they are ("v_N"), words lose their underscores ("time constant").
std::string number_title(const std::string& name) {
  constexpr std::size_t kSymbol = 4;  // letters
  return name.size() <= kSymbol ? name : effect_title(name);
}

std::string picture(const DiagnosisReport& report, std::optional<std::size_t> axis, Album& album) {
  if (!axis) return "";
  for (const PredictionTrace& trace : report.traces) {
    const std::size_t size = trace.t.size();
    const auto finite = [&](const auto& row) { return std::isfinite(row[*axis]); };
    if (size < 2 || trace.measured.size() != size || std::ranges::none_of(trace.before, finite)) continue;
    const auto stretch = typical_stretch(trace, kCloseUp);
    Figure drawn = draw_motion(trace, *axis, kMostPoints, stretch);
    drawn.alt = std::string{"What shows it: "} + velocity_label(kAxes[*axis]) + " measured, before and after";
    LivePlot live = live_motion(trace, *axis, stretch);
    live.group = "front";
    return figure(live_plot(album.place(std::move(drawn)), live, 1 + live.t.size() / kMostPoints),
                  escape("A typical stretch of " + trace.run + ", " + kAxes[*axis].name +
                         ": measured dark, before orange, after blue. At each light line the simulation starts anew."));
  }
  return "";
}

/// What the sensors say, not what the vehicle does: no force is missing for it.
bool of_sensor(const EffectFound& effect) {
  const model::Effect* known = model::find_effect(effect.name);
  return known != nullptr && known->measures();
}

std::string causes(const DiagnosisResult& result) {
  std::string items, own_flow;
  if (result.wiring) items += "<li>" + escape(join(result.wiring->readings, ", or ")) + "</li>\n";
  for (const EffectFound& effect : result.effects) {
    if (!effect.accepted) continue;
    if (of_own_flow(effect)) {
      own_flow += (own_flow.empty() ? "" : ", ") + effect_title(effect.name, effect.variant);
      continue;
    }
    std::string others;
    for (const Alternative& other : effect.alternatives)
      others += (others.empty() ? "" : ", ") + effect_title(other.name);
    const bool likely = effect.probability >= 0.5;
    const std::string what = of_sensor(effect) ? "In the sensors, and corrected: "
                             : likely          ? ""
                                               : "A stand-in, hardly the cause: ";
    items += "<li>" + what + cause_line(effect) + " <span class=\"soft\">" +
             "it is this cause: " + escape(sure(effect.probability)) +
             (others.empty() ? "" : "; or else " + escape(others)) + "</span></li>\n";
  }
  if (!own_flow.empty())
    items += "<li>What the craft's own flow does, by its nature: " + escape(own_flow) +
             " <span class=\"soft\">its numbers stand with the model's</span></li>\n";
  std::string refused;
  for (const StandIn& one : result.stand_ins) {
    if (!one.in_model) {
      refused += (refused.empty() ? "" : ", ") + effect_title(one.name, one.variant);
      continue;
    }
    items += "<li>A stand-in, no cause: " + escape(effect_title(one.name, one.variant)) + " <span class=\"soft\">" +
             escape(size_beside_rest(one.size, one.over)) + "; lowers the error on what was not fitted</span></li>\n";
  }
  if (!refused.empty())
    items += "<li><span class=\"soft\">Stand-ins that were tried and not taken, since the error does not fall: " +
             escape(refused) + "</span></li>\n";
  if (result.correction && result.correction->adopted)
    items += "<li>" + correction_line(*result.correction) + "</li>\n";
  return items.empty() ? "" : "<ul class=\"causes\">" + items + "</ul>\n";
}

}  // namespace

std::string sure(double probability) {
  constexpr double kNearly = 0.999;
  if (!std::isfinite(probability)) return "-";
  return probability > kNearly ? "> 99.9 %" : percent(probability);
}

std::string cause_line(const EffectFound& effect) {
  const std::string title = effect_title(effect.name, effect.variant), words = finding(effect);
  if (!words.empty()) return "<b>" + escape(words) + "</b> <span class=\"soft\">(" + escape(title) + ")</span>";
  std::string numbers;
  for (const NamedValue& value : effect.parameters)
    numbers += (numbers.empty() ? ": " : ", ") + number_title(value.name) + " " + plain_value(value);
  std::string line = title + numbers;
  if (!line.empty()) line[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(line[0])));
  return "<b>" + escape(line) + "</b>";
}

/// Axes that are predicted and of which no number is told; empty where none is told at all.
std::vector<std::size_t> axes_without_numbers(const DiagnosisResult& result) {
  std::vector<std::size_t> axes;
  if (result.parameters_after.empty() || result.error_after.prediction.empty()) return axes;
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    const std::string_view inertia = model::name(model::base_parameters()[axis]);
    const bool told =
        std::ranges::find(result.parameters_after, inertia, &NamedValue::name) != result.parameters_after.end();
    if (!told && std::isfinite(result.error_after.prediction.front().rmse[axis])) axes.push_back(axis);
  }
  return axes;
}

std::string front_section(const DiagnosisReport& report, Album& album) {
  const DiagnosisResult& result = report.result;
  Meaning said = meaning(result.verdict, result.wiring.has_value());
  if (result.verdict == "ambiguous" && !result.wiring) said = {"ambiguous", in_doubt(result)};
  std::optional<std::size_t> telling = telling_axis(result);
  if (result.verdict == "no_model" && !result.wiring) {
    std::string names;
    for (const std::size_t axis : axes_without_numbers(result)) {
      if (names.empty() && at_horizon(result.error_before) != nullptr) telling = axis;
      names += (names.empty() ? "" : ", ") + std::string{kAxes[axis].name};
    }
    if (!names.empty())
      said.words = "The model does not follow its thrust along " + names + ": those numbers are withheld";
  }
  if (result.verdict == "effect" && std::ranges::none_of(result.effects, claimed))
    said = {"adequate", "Nothing is missing but what the flow past this craft does, and that was found"};
  if (result.verdict == "unexplained" && !result.wiring && result.correction && result.correction->adopted)
    said.words = "None of the known causes fits: what is missing was learned";
  std::string html = "<header><h1>Why does " + escape(result.vehicle) +
                     " move as it does?</h1>\n<p class=\"soft\">Diagnosis of " + recordings(result) +
                     "</p>\n<div class=\"badge " + said.css + "\">" + escape(said.words) + "</div>\n" + causes(result) +
                     "<div class=\"tiles\">";
  const auto acts = [](const EffectFound& effect) { return effect.accepted && !of_sensor(effect); };
  const bool added = std::ranges::any_of(result.effects, acts) ||
                     std::ranges::any_of(result.stand_ins, &StandIn::in_model) ||
                     (result.correction && result.correction->adopted);
  if (std::isfinite(result.improvement.value) && !added) {
    html += tile("0 %", "change of the prediction error: nothing was added to the model");
  } else if (std::isfinite(result.improvement.value)) {
    html += tile(percent(-result.improvement.value),
                 "change of the prediction error " + five_seconds_ahead(result.foretold) + " (" +
                     percent_interval(-result.improvement.high, -result.improvement.low) + ")");
  }
  if (telling && at_horizon(result.error_before) != nullptr && at_horizon(result.error_after) != nullptr) {
    const Axis& a = kAxes[*telling];
    const auto rmse = [&](const ModelError& error) { return number(a.scale * at_horizon(error)->rmse[*telling], 3); };
    html += tile((added ? rmse(result.error_before) + " → " : std::string{}) + rmse(result.error_after) + " " + a.unit,
                 std::string{"error of "} + a.name + " " + five_seconds_ahead(result.foretold) +
                     (added ? ", before → after" : ""));
  }
  const std::size_t doubts = group_findings(result.consistency).size();
  html += tile(std::to_string(doubts), doubts == 1 ? "doubt about a sensor" : "doubts about sensors");
  const bool judged = !result.error_after.prediction.empty();
  html += tile(join(result.validate, ", "), judged ? "judged on, not used in the fit" : "too short to judge on");
  html += "</div>\n" + picture(report, telling, album);
  if (!result.manoeuvre.empty()) html += "<p class=\"note\"><b>Next.</b> " + escape(result.manoeuvre) + "</p>\n";
  if (!result.paragraph.empty())
    html += "<details><summary>The whole verdict in words</summary>" + lines(result.paragraph) + "</details>\n";
  return html + "</header>\n";
}

}  // namespace fathom::report

// Sections of the report page that are mostly tables: sensors, candidates, parameters, certainty.
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/report/page_parts.hpp"
#include "common/report/pictures.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

struct Scale {
  double low{};
  double high{};
  [[nodiscard]] double at(double value) const { return 100.0 * std::clamp((value - low) / (high - low), 0.0, 1.0); }
};

std::string per_cent(double value) { return number(value, 3) + "%"; }

std::string bar(const Scale& scale, double value) {
  const double zero = scale.at(0.0);
  std::string html = "<div class=\"bar\">";
  if (std::isfinite(value)) {
    const double end = scale.at(value);
    html += "<span style=\"left:" + per_cent(std::min(zero, end)) + ";width:" + per_cent(std::abs(end - zero)) +
            "\"></span>";
  }
  return html + "<u style=\"left:" + per_cent(zero) + "\"></u></div>";
}

/// "tether tension (3 : 1 against it)", one after the other.
std::string rivals(const EffectFound& effect) {
  std::string names;
  for (const Alternative& other : effect.alternatives)
    names += (names.empty() ? "" : ", ") + effect_title(other.name, "") + " (" + odds(other.log_odds) + " against it)";
  return escape(names + ".");
}

std::string interval_cell(const NamedValue* value) {
  if (value == nullptr) return cell("-", "n");
  NamedValue bare = *value;
  bare.unit.clear();
  return cell(escape(with_interval(bare)), "n");
}

const NamedValue* find(const std::vector<NamedValue>& values, const std::string& name) {
  const auto found = std::ranges::find(values, name, &NamedValue::name);
  return found == values.end() ? nullptr : &*found;
}

Whisker whisker(const NamedValue* value, const char* colour) {
  const double nothing = std::nan("");
  if (value == nullptr) return {nothing, nothing, nothing, colour};
  const auto [low, high] = value->range95();
  return {low, value->value, high, colour};
}

std::string parameter_row(const NamedValue* before, const NamedValue* after) {
  const NamedValue& any = after ? *after : *before;
  const std::vector<Whisker> rows{whisker(before, kBeforeColour), whisker(after, kAfterColour)};
  double low = 0.0;  // zero is in the picture, so that "is it there at all?" can be seen
  double high = 0.0;
  for (const auto& w : rows) {
    low = std::fmin(low, std::fmin(w.low, w.value));
    high = std::fmax(high, std::fmax(w.high, w.value));
  }
  return "<tr>" + cell(escape(any.name), "k") + interval_cell(before) + interval_cell(after) + cell(escape(any.unit)) +
         cell(whiskers(rows, low, high, 0.0), "mid") + "</tr>\n";
}

}  // namespace

std::string sensor_section(const DiagnosisReport& report) {
  const DiagnosisResult& result = report.result;
  const auto groups = group_findings(result.consistency);
  std::string html = "<section><h2>What was measured, and where it is doubtful</h2>\n<p>The model was fitted on <b>" +
                     escape(join(result.train, ", ")) + "</b> and judged only on <b>" +
                     escape(join(result.validate, ", ")) + "</b>, which the fit never saw. ";
  if (groups.empty()) {
    return html +
           "Sensors that see the same motion were held against each other before the fit; no disagreement was "
           "found.</p></section>\n";
  }
  html +=
      "Before the fit, sensors that see the same motion were held against each other. Where they disagree, the last "
      "column says what the fit does about it.</p>\n<table>" +
      heading_cells({"Signal", "held against", "finding", "size", "evidence", "what the fit does"}, {3});
  for (const auto& group : groups) {
    const ConsistencyFinding& f = *group.members.front();
    std::string evidence = escape(f.evidence);
    if (group.members.size() > 1) {
      evidence += "<details><summary>all " + std::to_string(group.members.size()) + " runs</summary>";
      for (const auto* member : group.members) {
        evidence += "<p><b>" + escape(member->run) + "</b>: " + escape(number(member->size) + " " + member->unit) +
                    ". " + escape(member->evidence) + "</p>";
      }
      evidence += "</details>";
    } else {
      evidence += " <span class=\"soft\">(" + escape(f.run == "all" ? "all runs" : f.run) + ")</span>";
    }
    html += "<tr>" + cell(escape(f.signal), "k") + cell(escape(f.reference)) +
            cell("<b>" + escape(effect_title(f.finding)) + "</b>") + cell(escape(size_text(group)), "n") +
            cell(evidence) + cell(escape(f.action)) + "</tr>\n";
  }
  return html + "</table></section>\n";
}

std::string candidate_section(const DiagnosisResult& result) {
  std::string html = "<section><h2>Which causes were suspected</h2>\n";
  if (result.candidates.empty()) return html + "<p>No cause was tried.</p></section>\n";
  html +=
      "<p>Each known effect was asked. <b>It is this cause</b>: how likely the name is right, beside nothing and "
      "beside every other name; asked of what was kept alone.</p>\n<table>" +
      heading_cells({"Suspected cause", "it is this cause", "why"}, {});
  std::vector<const CandidateTried*> ranked;
  for (const auto& candidate : result.candidates) ranked.push_back(&candidate);
  std::stable_partition(ranked.begin(), ranked.end(),  // clang 14 does not compile the one of std::ranges
                        [&](const CandidateTried* c) { return accepted_form(result, *c) != nullptr; });
  constexpr Scale kWhole{0.0, 1.0};
  for (const auto* c : ranked) {
    const EffectFound* found = accepted_form(result, *c);
    const std::string mark = !found                            ? "<span class=\"mark no\">refused</span>"
                             : result.verdict == "unexplained" ? "<span class=\"mark\">kept</span>"
                                                               : "<span class=\"mark\">accepted</span>";
    const double probability = found ? found->probability : std::nan("");
    html += std::string("<tr") + (found ? " class=\"yes\">" : ">") +
            cell(escape(effect_title(c->name, c->variant)) + "<br>" + mark, "name") +
            (found ? cell(bar(kWhole, probability) + "<div>" + escape(sure(probability)) + "</div>", "bars")
                   : cell("<span class=\"soft\">not asked</span>", "bars")) +
            cell(escape(c->reason)) + "</tr>\n";
  }
  return html + "</table></section>\n";
}

std::string parameter_section(const DiagnosisResult& result) {
  std::string html =
      "<section><h2>The numbers of the model</h2>\n<p>Before: the base model alone. After: with the accepted "
      "effects. Values with their 95 % interval: half its width, or its ends where the sides differ; in the pictures "
      "the thin line is zero.</p>\n";
  std::string rows;
  for (const auto& after : result.parameters_after)
    rows += parameter_row(find(result.parameters_before, after.name), &after);
  for (const auto& before : result.parameters_before) {
    if (find(result.parameters_after, before.name) == nullptr) rows += parameter_row(&before, nullptr);
  }
  for (const auto& effect : result.effects) {
    std::string own;
    for (const auto& value : effect.parameters) {
      if (find(result.parameters_after, value.name) == nullptr) own += parameter_row(nullptr, &value);
    }
    if (effect.accepted && !own.empty()) {
      rows += "<tr class=\"sub\"><td colspan=\"5\">" + escape(effect_title(effect.name, effect.variant)) +
              "</td></tr>\n" + own;
    }
  }
  for (const StandIn& one : result.stand_ins) {
    if (!one.in_model) continue;
    rows += "<tr class=\"sub\"><td colspan=\"5\">" + escape(effect_title(one.name, one.variant)) +
            " (stand-in)</td></tr>\n";
    for (const NamedValue& value : one.parameters) rows += parameter_row(nullptr, &value);
  }
  if (rows.empty()) return html + "<p>No parameter was fitted.</p></section>\n";
  return html + "<table>" +
         heading_cells({"Parameter", "before", "after", "unit", "before (orange, above) and after (blue, below)"},
                       {1, 2}) +
         rows + "</table></section>\n";
}

std::string certainty_section(const DiagnosisResult& result) {
  std::string html = "<section><h2>How sure this is, and what would settle the rest</h2>\n";
  const Interval& gain = result.improvement;
  if (std::ranges::none_of(result.effects, &EffectFound::accepted) &&
      std::ranges::none_of(result.stand_ins, &StandIn::in_model)) {
    html += "<p>Nothing was added to the model: it foretells what it foretold before.</p>\n";
  } else if (std::isfinite(gain.value) && !std::isfinite(gain.low)) {
    html += "<p>The normalised error " + five_seconds_ahead(result.foretold) + " changed by <b>" +
            escape(percent(-gain.value)) + "</b>. Too few windows judge for an interval: drive longer.</p>\n";
  } else if (std::isfinite(gain.value)) {
    const bool sure = gain.low > 0.0;
    const double low = std::fmin(0.0, gain.low);
    html += "<p>The normalised error " + five_seconds_ahead(result.foretold) + " changed by <b>" +
            escape(percent(-gain.value)) +
            "</b>. With 95 % confidence "
            "the reduction lies between " +
            escape(percent(gain.low)) + " and " + escape(percent(gain.high)) +
            (sure ? ", so it is more than luck.</p>"
                  : ", so it may be luck: the interval includes no improvement at all.</p>") +
            "<div style=\"max-width:560px\">" +
            whiskers({{gain.low, gain.value, gain.high, kAfterColour}}, low, 1.0, 0.0) +
            "</div><p class=\"small soft\">Left line: no improvement. Right end: no error left.</p>\n";
  }
  std::string open;
  for (const auto& effect : result.effects) {
    if (!effect.sentence.empty()) {
      html += "<p class=\"note\">" + escape(effect.sentence) +
              " <b>It is this cause: " + escape(sure(effect.probability)) + ".</b></p>\n";
    }
    if (!effect.alternatives.empty()) {
      open += "<li>On this data, <b>" + escape(effect_title(effect.name, effect.variant)) +
              "</b> cannot be told apart from " + rivals(effect) + "</li>\n";
    }
  }
  for (const auto& axis : result.residual_after) {
    if (!axis.remembers() && !axis.swings()) continue;
    const auto named = std::ranges::find_if(kAxes, [&](const Axis& a) { return axis.axis == a.force; });
    open += "<li>What is left in <b>" + escape(named == kAxes.end() ? axis.axis : std::string(named->name)) + "</b> " +
            (axis.swings()
                 ? "swings, every " + escape(number(axis.swing_period_s, 2)) + " s or so, as by " +
                       std::string(kWhatSwings) + ".</li>\n"
                 : "remembers itself for about " + escape(number(axis.autocorrelation_time_s, 2)) +
                       " s: a random force does (turbulence, a swinging tether), and so does something small that is "
                       "still missing.</li>\n");
  }
  for (const NotMeasured& group : result.not_measured) {
    if (!group.means.empty()) open += "<li>" + escape(group.means) + "</li>\n";
  }
  const bool judged = result.verdict != "unjudged";
  if (judged || !open.empty())
    html += open.empty() ? "<p>Nothing is left open on this data.</p>\n" : "<h3>Still open</h3><ul>" + open + "</ul>\n";
  if (!result.manoeuvre.empty())
    html += "<h3>What to drive next</h3><p class=\"lead\">" + escape(result.manoeuvre) + "</p>\n";
  return html + "</section>\n";
}

}  // namespace fathom::report

// Lays out the verdict table for the terminal; every line is cut or wrapped to kTableColumns.
#include "common/report/table.hpp"

#include <algorithm>
#include <cmath>

#include "common/report/correction.hpp"
#include "common/report/page_parts.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr std::size_t kLabelWidth = 15;     // "surge u [m/s]", "pitch q [deg/s]"
constexpr std::size_t kHorizonsPerRow = 3;  // three cells of 26 columns fill the line
constexpr std::size_t kNameWidth = 27;      // of an effect with its variant
constexpr std::size_t kFindingsShown = 8;   // the report page has all of them

class Text {
 public:
  void line(std::string_view text) {
    text_ += text.substr(0, text.find_last_not_of(' ') + 1);
    text_ += '\n';
  }

  void title(const std::string& title) {
    const std::string head = "── " + title + " ";
    std::string rule = pad_right(head, std::min(columns(head), kTableColumns));
    for (std::size_t i = columns(rule); i < kTableColumns; ++i) rule += "─";
    line("");
    line(rule);
  }

  // Wrapped; `first` begins the first line, the others are indented to its width.
  void paragraph(std::string_view text, const std::string& first = "  ") {
    const std::size_t indent = columns(first);
    std::string start = first;
    for (const auto& part : wrap(text, kTableColumns - indent)) {
      line(start + part);
      start = std::string(indent, ' ');
    }
  }

  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

const PredictionError* at_horizon(const ModelError& error, double horizon) {
  const auto found = std::ranges::find(error.prediction, horizon, &PredictionError::horizon_s);
  return found == error.prediction.end() ? nullptr : &*found;
}

// At most six columns over the range that errors have.
std::string six_columns(double value) { return number(value, std::abs(value) < 0.01 ? 2 : 3); }

std::string cell(const PredictionError* before, const PredictionError* after, std::size_t axis) {
  const double nothing = std::nan("");
  const double scale = kAxes[axis].scale;
  const auto rmse = [&](const PredictionError* e) { return six_columns(scale * (e ? e->rmse[axis] : nothing)); };
  const auto r2 = [&](const PredictionError* e) { return r_squared(e ? e->r2[axis] : nothing); };
  return pad_left(rmse(before), 6) + "→" + pad_right(rmse(after), 6) + " " + pad_left(r2(before), 5) + "→" +
         pad_right(r2(after), 5);
}

void errors(Text& out, const DiagnosisResult& result) {
  std::vector<double> horizons;
  for (const auto& p : result.error_after.prediction) horizons.push_back(p.horizon_s);
  if (horizons.empty()) {
    for (const auto& p : result.error_before.prediction) horizons.push_back(p.horizon_s);
  }
  out.title("Prediction error on " + join(result.validate, ", ") + ", before→after");
  if (horizons.empty()) return out.line("  none was computed");
  for (std::size_t first = 0; first < horizons.size(); first += kHorizonsPerRow) {
    const std::size_t last = std::min(first + kHorizonsPerRow, horizons.size());
    std::string ahead = std::string(kLabelWidth, ' ');
    std::string head = pad_right("axis", kLabelWidth);
    for (std::size_t h = first; h < last; ++h) {
      ahead += "  " + pad_right("   " + plain(horizons[h]) + " s ahead", 25);
      head += "  " + pad_right("   rms error", 14) + pad_right("   R²", 11);
    }
    out.line(ahead);
    out.line(head);
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      if (!predicted(result, axis)) continue;
      std::string row = pad_right(velocity_label(kAxes[axis]), kLabelWidth);
      for (std::size_t h = first; h < last; ++h) {
        row += "  " +
               cell(at_horizon(result.error_before, horizons[h]), at_horizon(result.error_after, horizons[h]), axis);
      }
      out.line(row);
    }
  }
  if (const std::string words = how_far(result.foretold); !words.empty()) out.paragraph(words);
  if (std::isfinite(result.improvement.value)) {
    out.paragraph("Normalised error " + five_seconds_ahead(result.foretold) + ": reduced by " +
                  percent(result.improvement.value) + " (" +
                  percent_interval(result.improvement.low, result.improvement.high) + ").");
  }
}

std::string head_of_scores(const char* last) { return "  " + pad_right("", kNameWidth) + " log odds  " + last; }

std::string score(const std::string& title, double log_odds) {
  return "  " + pad_right(title, kNameWidth) + " " + pad_left(log_odds_text(log_odds), 8) + "  ";
}

void accepted(Text& out, const DiagnosisResult& result) {
  out.title(result.verdict == "unexplained" && !result.effects.empty() ? "Effects kept" : "Effects accepted");
  if (std::ranges::any_of(result.effects, &EffectFound::accepted)) out.line(head_of_scores("probability"));
  bool any = false;
  for (const auto& effect : result.effects) {
    if (!effect.accepted) continue;
    any = true;
    out.line(score(effect_title(effect.name, effect.variant), effect.log_odds) + sure(effect.probability));
    for (const auto& value : effect.parameters) out.paragraph(value.name + " = " + with_interval(value), "      ");
    for (const Alternative& other : effect.alternatives)
      out.paragraph("cannot be told apart from " + other.name + " (" + odds(other.log_odds) + " against it)", "      ");
  }
  if (!any) out.line("  none");
}

void stand_ins(Text& out, const DiagnosisResult& result) {
  if (result.stand_ins.empty()) return;
  out.title("Stand-ins: no cause is claimed");
  for (const StandIn& one : result.stand_ins) {
    out.paragraph(effect_title(one.name, one.variant) + ": " + size_beside_rest(one.size, one.over) + "; " +
                  (one.in_model ? "it lowers the error on what was not fitted, so the model has it"
                                : "it does not lower the error on what was not fitted, so the model lacks it"));
    for (const NamedValue& value : one.parameters) out.paragraph(value.name + " = " + with_interval(value), "      ");
  }
}

void refused(Text& out, const DiagnosisResult& result) {
  out.title("Effects refused");
  bool any = false;
  for (const auto& candidate : result.candidates) {
    if (accepted_form(result, candidate) != nullptr) continue;
    if (!any) out.line(head_of_scores("why"));
    any = true;
    const std::string start = score(effect_title(candidate.name, candidate.variant), candidate.log_odds);
    out.line(start + pad_right(candidate.reason, kTableColumns - columns(start)));
  }
  if (!any) out.line("  none");
}

void sensors(Text& out, const DiagnosisResult& result) {
  out.title("Sensors that disagree");
  const auto groups = group_findings(result.consistency);
  if (groups.empty()) out.line("  none found");
  for (std::size_t i = 0; i < std::min(groups.size(), kFindingsShown); ++i) {
    const ConsistencyFinding& f = *groups[i].members.front();
    const std::string runs =
        groups[i].members.size() > 1 ? std::to_string(groups[i].members.size()) + " runs" : "run " + f.run;
    out.paragraph(f.signal + " against " + f.reference + ": " + effect_title(f.finding) + " " + size_text(groups[i]) +
                      " (" + (f.run == "all" ? "all runs" : runs) + ")" + (f.action.empty() ? "" : "; " + f.action),
                  "  · ");
  }
  if (groups.size() > kFindingsShown) {
    out.line("    and " + std::to_string(groups.size() - kFindingsShown) + " more in the report");
  }
}

}  // namespace

std::string to_table(const DiagnosisResult& result) {
  Text out;
  out.title("Verdict for " + result.vehicle + ": " + result.verdict);
  out.paragraph(result.paragraph);
  errors(out, result);
  accepted(out, result);
  stand_ins(out, result);
  if (const std::string words = correction_words(result); !words.empty()) {
    out.title("Correction: no cause");
    out.paragraph(words);
  }
  refused(out, result);
  sensors(out, result);
  return out.take().substr(1);  // without the blank line above the first title
}

}  // namespace fathom::report

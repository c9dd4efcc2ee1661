#include "common/result/explain.hpp"

#include <algorithm>
#include <cmath>

#include "common/result/cause_words.hpp"
#include "common/result/lines.hpp"

namespace fathom::result {
namespace {

using report::number;
using report::percent;

constexpr double kHorizon = 5.0;         // s, of the errors that are told
constexpr std::size_t kMostRefused = 8;  // the file has all

std::string value_and_threshold(const CauseGiven& cause, const CauseWords* words) {
  if (!std::isfinite(cause.value) && !std::isfinite(cause.threshold)) return "";
  std::string text = words != nullptr && !words->quantity.empty() ? std::string{words->quantity} + " " : "value ";
  text += number(cause.value);
  if (std::isfinite(cause.threshold)) text += ", threshold " + number(cause.threshold);
  return text;
}

void data(Lines& out, const Stored& stored) {
  const DiagnosisResult& result = stored.result;
  out.title("1. The data");
  std::string words =
      "fitted: " + report::join(result.train, ", ") + "; judged on: " + report::join(result.validate, ", ");
  if (!stored.begin.empty()) words += "; recorded " + stored.begin + " to " + stored.end;
  out.line(words);
  for (const OriginFile& file : stored.origin.files)
    out.line(file.path + "  sha256 " + file.sha256.substr(0, 12) + "...", report::pad_right("    " + file.role, 14),
             14);
  if (!stored.origin.command.empty()) out.line("by: " + stored.origin.command);
}

void sensors(Lines& out, const DiagnosisResult& result) {
  const auto groups = report::group_findings(result.consistency);
  out.title("2. Do the sensors agree with each other?");
  if (groups.empty()) out.line("No disagreement was found.");
  for (const auto& group : groups) {
    const ConsistencyFinding& f = *group.members.front();
    out.line(f.signal + " against " + f.reference + ": " + f.finding + " " + report::size_text(group) +
                 (f.action.empty() ? "" : "; " + f.action),
             "  · ");
  }
  for (const NotMeasured& group : result.not_measured) {
    out.line(
        "not measured: " + group.group + (group.means.empty() ? "" : ". " + group.means) +
            (group.cannot_be_asked.empty() ? ""
                                           : " Could not be asked: " + report::join(group.cannot_be_asked, ", ") + "."),
        "  · ");
  }
}

const PredictionError* at_horizon(const ModelError& error) {
  const auto found = std::ranges::find(error.prediction, kHorizon, &PredictionError::horizon_s);
  return found == error.prediction.end() ? nullptr : &*found;
}

void errors(Lines& out, const DiagnosisResult& result) {
  out.title("4. Does it hold on data that no fit has seen? (predictions 5 s ahead)");
  const PredictionError *before = at_horizon(result.error_before), *after = at_horizon(result.error_after);
  if (before == nullptr || after == nullptr) {
    out.line("Too little data: no prediction was judged.");
    return;
  }
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!report::predicted(result, axis)) continue;
    const report::Axis& a = report::kAxes[axis];
    out.line("rms " + number(a.scale * before->rmse[axis]) + " -> " + number(a.scale * after->rmse[axis]) + " " +
                 a.unit + ", R2 " + report::r_squared(before->r2[axis]) + " -> " + report::r_squared(after->r2[axis]),
             "    " + std::string{a.name} + " " + a.velocity, 14);
  }
  if (std::isfinite(result.improvement.value))
    out.line("normalised error: " + percent(result.improvement.value) + " less (" +
             report::percent_interval(result.improvement.low, result.improvement.high) +
             "; above 0 throughout it is more than luck)");
}

void evidence(Lines& out, const Stored& stored) {
  out.title("3. What was suspected, and what the evidence says");
  for (const EffectFound& effect : stored.result.effects) {
    if (!effect.accepted) continue;
    out.line(report::effect_title(effect.name, effect.variant) + ": it is this cause: " + percent(effect.probability) +
                 ", log odds " + report::log_odds_text(effect.log_odds),
             "  + ");
    for (const NamedValue& value : effect.parameters)
      out.line(value.name + " = " + report::with_interval(value), "", 6);
    for (const Alternative& other : effect.alternatives)
      out.line("or " + other.name + ": " + report::odds(other.log_odds) + " against it", "", 6);
  }
  for (const StandIn& one : stored.result.stand_ins)
    out.line(report::effect_title(one.name, one.variant) + ": a stand-in for something unlisted, " +
                 report::size_beside_rest(one.size, one.over) + "; " +
                 (one.in_model ? "in the model" : "not in the model: the error does not fall with it"),
             "  ~ ");
  std::size_t told = 0, more = 0;
  for (const CandidateTried& candidate : stored.result.candidates) {
    if (report::accepted_form(stored.result, candidate) != nullptr) continue;
    if (told == kMostRefused) {
      ++more;
      continue;
    }
    ++told;
    std::string words = report::effect_title(candidate.name, candidate.variant) + ": " + candidate.reason;
    if (!stored.given.refusals.contains(candidate.name) && std::isfinite(candidate.log_odds))
      words += "; log odds " + report::log_odds_text(candidate.log_odds);
    out.line(words, "  - ");
  }
  if (more > 0) out.line("and " + std::to_string(more) + " more refused: 'candidates' in the file");
}

void residual(Lines& out, const DiagnosisResult& result) {
  out.title("5. What is left?");
  for (const AxisWhiteness& axis : result.residual_after) {
    out.line((axis.remembers() ? "remembers itself for " : "white enough: memory ") +
                 number(axis.autocorrelation_time_s, 2) + " s (threshold " + number(kNoMemory) + "), p " +
                 number(axis.p_value, 2) + " (threshold " + number(kNotRandom) + "), " + percent(axis.explained) +
                 " of the applied wrench accounted for" +
                 (axis.swings() ? ", swings every " + number(axis.swing_period_s, 2) + " s" : ""),
             "    " + axis.axis, 8);
  }
}

}  // namespace

std::string explained(const Stored& stored) {
  const DiagnosisResult& result = stored.result;
  Lines out;
  out.title(result.vehicle + ": " + result.verdict);
  if (!result.paragraph.empty()) out.line(result.paragraph, "", 2);
  data(out, stored);
  sensors(out, result);
  evidence(out, stored);
  errors(out, result);
  residual(out, result);
  if (result.correction)
    out.line(result.correction->adopted ? "a correction was learned, which is no cause: " + result.correction->words
                                        : "no correction was learned: " + result.correction->refused,
             "  ! ");
  out.title("So: " + result.verdict + ", because");
  for (const CauseGiven& cause : stored.given.causes) {
    const CauseWords* words = words_of(cause.cause);
    std::string text = words != nullptr ? std::string{words->sentence} : cause.cause;
    if (!cause.of.empty()) text += ": " + cause.of;
    const std::string numbers = value_and_threshold(cause, words);
    out.line(text + (numbers.empty() ? "" : " (" + numbers + ")"), "  > ");
  }
  if (stored.given.causes.empty()) out.line("the file states no causes: it was written by an older version");
  out.title("What to do next");
  const bool settled = result.verdict == "adequate" || result.verdict == "effect";
  if (!result.manoeuvre.empty()) {
    out.line(result.manoeuvre);
  } else {
    out.line(settled ? "Nothing is open on this data."
                     : "What is open is told above; no motion was worked out for it.");
  }
  for (const EffectFound& effect : result.effects) {
    for (const ToldApart& told : effect.told_apart)
      out.line("'fathom fly' the segment \"" + told.segment + "\" for " + number(told.seconds) + " s: it tells " +
                   effect.name + " from " + told.name,
               "  · ");
  }
  return out.text();
}

}  // namespace fathom::result

// The outcome of a live trial for the terminal: modes, parameters, suspects; beside them what the truth says.
#include <algorithm>
#include <cmath>

#include "common/report/live/live_trial.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr std::size_t kColumns = 100;
constexpr std::size_t kBestOf = 3;

std::string rule(const std::string& title) {
  std::string line = "── " + title + " ";
  while (columns(line) < kColumns) line += "─";
  return line + "\n";
}

std::string modes(const LiveTrialResult& result) {
  if (result.visits.empty() && result.flights.empty()) return "";
  std::string text = rule("Modes");
  text += pad_right("mode", 10) + pad_left("from", 8) + pad_left("to", 8) + pad_left("metric", 11) +
          pad_left("threshold", 11) + "  outcome\n";
  for (const ModeVisit& visit : result.visits) {
    text += pad_right(visit.mode, 10) + pad_left(number(visit.begun, 4) + " s", 8) +
            pad_left(number(visit.ended, 4) + " s", 8) +
            pad_left(visit.metric < 0.0 ? "-" : number(visit.metric, 3), 11) +
            pad_left(number(visit.threshold, 3), 11) + "  " + (visit.left ? "settled" : "not settled") + "\n";
    if (visit.left || visit.missing.empty()) continue;
    for (const std::string& line : wrap("missing: " + visit.missing, kColumns - 4)) text += "    " + line + "\n";
  }
  for (const FlownSegment& flight : result.flights) {
    text += pad_right(kSegmentMode, 10) + pad_left(number(flight.begun, 4) + " s", 8) +
            pad_left(number(flight.ended, 4) + " s", 8) + pad_left("-", 11) + pad_left("-", 11) + "  " +
            flight.segment + "\n";
  }
  return text;
}

std::string parameters(const LiveTrialResult& result) {
  if (result.parameters.empty()) return "";
  std::string text = rule("Identified (± 95 %)") + "  " + estimate_words(result) + "\n";
  for (const std::string& line : wrap(doubt_words(result), kColumns - 2)) text += "  " + line + "\n";
  text += pad_right("", 10) + pad_left("identified", 24) + "  " + pad_right("unit", 16);
  if (result.truth) text += pad_left("truth", 10) + pad_left("error", 10) + "  interval";
  text += "\n";
  for (const NamedValue& p : result.parameters) {
    text += pad_right(p.name, 10) + pad_left(number(p.value, 4) + " ± " + number(kNormal95 * p.std, 2), 24) + "  " +
            pad_right(p.unit, 16);
    if (result.truth) {
      const auto found = result.truth->parameters.find(p.name);
      if (found != result.truth->parameters.end()) {
        const double error = p.value - found->second;
        text += pad_left(number(found->second, 4), 10) +
                pad_left(number(100.0 * error / std::abs(found->second), 2) + " %", 10) + "  " +
                (std::abs(error) <= kNormal95 * p.std ? "holds the truth" : "MISSES THE TRUTH");
      }
    }
    text += "\n";
  }
  return text;
}

std::string suspects(const LiveTrialResult& result) {
  if (result.ranking.verdict.empty()) return "";
  std::string text = rule("Diagnoser: " + result.ranking.verdict);
  for (std::size_t i = 0; i < std::min(kBestOf, result.ranking.candidates.size()); ++i) {
    const EffectEvidence& one = result.ranking.candidates[i];
    text += "  " + pad_right(effect_title(one.name), 28) + "log odds " + pad_left(number(one.log_odds, 3), 7) +
            ", explains " + percent(one.error_reduction) + "\n";
  }
  if (result.learned)
    text += (result.learned->adopted ? "  learned: " : "  not learned: ") + result.learned->words + "\n";
  text += "  in the identifier's model: " + (result.adopted.empty() ? "no effect" : join(result.adopted, ", ")) + "\n";
  for (const NamedValue& p : result.effect_numbers) {
    text += "    " + pad_right(p.name, 32) + number(p.value, 4) + " ± " + number(kNormal95 * p.std, 2) +
            (p.unit.empty() ? "" : " " + p.unit) + "\n";
  }
  return text;
}

std::string truth(const TruthComparison& truth) {
  std::string text = rule("Compared with the simulator's truth, which no process heard");
  text += "  hidden: " + (truth.effects.empty() ? "no effect" : join(truth.effects, "; ")) + "\n";
  const auto triple = [](const std::array<double, 6>& values, std::size_t first, double scale) {
    return number(scale * values[first], 2) + "  " + number(scale * values[first + 1], 2) + "  " +
           number(scale * values[first + 2], 2);
  };
  text += "  rms error of position x y z: " + triple(truth.state_rms, 0, 1e3) +
          " mm, of velocity u v w: " + triple(truth.state_rms, 3, 1e3) + " mm/s\n";
  text += "  contacts: walls " + std::to_string(truth.contacts[0]) + ", floor " + std::to_string(truth.contacts[1]) +
          ", surface " + std::to_string(truth.contacts[2]) + "\n";
  return text;
}

}  // namespace

std::string to_table(const LiveTrialResult& result) {
  std::string text = rule(trial_title(result) + " (" + result.site + "): " + result.phase + " after " +
                          number(result.seconds, 4) + " s");
  for (const std::string& line : wrap(result.reason, kColumns - 2)) text += "  " + line + "\n";
  text += modes(result) + parameters(result) + suspects(result);
  for (const auto& [process, words] : result.complaints) text += "  " + process + " said " + words + "\n";
  if (result.afterwards) {
    std::vector<std::string> names;
    for (const EffectEvidence& one : result.afterwards->effects) names.push_back(one.name);
    text += "  the loop closed on the log: " + result.afterwards->verdict +
            (names.empty() ? "" : " (" + join(names, ", ") + ")") + "; " + result.afterwards->page + "\n";
  }
  if (result.truth) text += truth(*result.truth);
  return text;
}

}  // namespace fathom::report

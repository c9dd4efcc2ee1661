#include "common/live/ranking.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::live {
namespace {

constexpr std::size_t kMost = 8;  // candidates: who reads more of them reads `fathom diagnose`

/// Numbers of the effect in the order of its parameters; those of a sensor's fault as they were found.
std::vector<double> numbers_of(const EffectFound& effect, const likelihood::Fit& best) {
  for (const model::ActiveEffect& active : best.hypothesis.model.effects) {
    if (active.effect->name() == effect.name && active.variant_name == effect.variant) return active.theta;
  }
  std::vector<double> numbers;
  for (const NamedValue& number : effect.parameters) numbers.push_back(number.value);
  return numbers;
}

}  // namespace

EffectRanking ranking_of(const verdict::Answer& answer) {
  const DiagnosisResult& result = answer.report.result;
  EffectRanking ranking{.verdict = result.verdict};
  const bool named = result.verdict == "effect" || result.verdict == "ambiguous";
  const double falls = named ? result.improvement.value : 0.0;
  for (const EffectFound& effect : result.effects) {
    ranking.candidates.push_back({.name = effect.name,
                                  .log_odds = effect.log_odds,
                                  .error_reduction = std::isfinite(falls) ? std::clamp(falls, 0.0, 1.0) : 0.0,
                                  .variant = effect.variant,
                                  .numbers = numbers_of(effect, answer.best)});
  }
  std::vector<EffectEvidence> others;
  for (const CandidateTried& candidate : result.candidates) {
    const auto same = [&](const auto& other) {
      return other.name == candidate.name && other.variant == candidate.variant;
    };
    if (!std::isfinite(candidate.log_odds) || std::ranges::any_of(result.effects, same) ||
        std::ranges::any_of(result.stand_ins, same))
      continue;
    others.push_back({.name = candidate.name, .log_odds = candidate.log_odds, .variant = candidate.variant});
  }
  std::ranges::stable_sort(others, std::greater{}, &EffectEvidence::log_odds);
  std::ranges::move(others, std::back_inserter(ranking.candidates));
  if (ranking.candidates.size() > kMost) ranking.candidates.resize(kMost);
  if (answer.rivals) ranking.against = answer.rivals->second.effect->name();
  return ranking;
}

std::optional<LearnedTold> learned_of(const verdict::Answer& answer) {
  const auto& correction = answer.report.result.correction;
  if (!correction || !correction->asked) return {};
  const auto told = [](double value, double otherwise) { return std::isfinite(value) ? value : otherwise; };
  LearnedTold learned{.adopted = correction->adopted,
                      .log_odds = told(correction->log_odds, 0.0),
                      .size = told(correction->size, 0.0),
                      .held_out = told(correction->held_out, 1.0),
                      .words = correction->adopted ? correction->words : correction->refused,
                      .equation = {},
                      .numbers = {}};
  if (correction->adopted && correction->formula) {
    learned.equation = correction->formula->equation;
    learned.numbers = correction->formula->numbers;
  }
  return learned;
}

Rivals rivals_of(const verdict::Answer& answer) {
  const auto& rivals = answer.rivals;
  const auto flown = [](const model::ActiveEffect& active) {
    return !active.effect->measures() && model::find_effect(active.effect->name()) != nullptr;
  };
  return rivals && flown(rivals->first) && flown(rivals->second) ? rivals : Rivals{};
}

}  // namespace fathom::live

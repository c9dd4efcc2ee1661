#include "common/verdict/lists.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "common/preflight/applicability.hpp"
#include "common/verdict/by_likelihood.hpp"

namespace fathom::verdict {
namespace {

using inference::Conclusion;
using inference::Verdict;
using likelihood::NumberKind;

/// Numbers of the effect of that place in the model.
std::vector<NamedValue> numbers_of_effect(const likelihood::Fit& fit, std::size_t effect,
                                          const Eigen::VectorXd& sigma) {
  std::vector<NamedValue> values;
  for (std::size_t j = 0; j < fit.numbers.size(); ++j) {
    const likelihood::Number& number = fit.numbers[j];
    if (number.kind != NumberKind::kEffect || number.index != static_cast<int>(effect)) continue;
    values.push_back({number.name.substr(number.name.find('.') + 1), value(fit.hypothesis, number),
                      sigma[static_cast<Eigen::Index>(j)], number.unit});
  }
  return values;
}

}  // namespace

std::vector<NamedValue> numbers_of(const likelihood::Fit& fit, const Eigen::VectorXd& sigma,
                                   const std::set<int>& withheld) {
  std::vector<NamedValue> values;
  if (!fit.finite || sigma.size() != static_cast<Eigen::Index>(fit.numbers.size())) return values;
  for (std::size_t j = 0; j < fit.numbers.size(); ++j) {
    if (fit.numbers[j].kind == NumberKind::kWeight) continue;
    const auto base = model::parameter_from_name(fit.numbers[j].name);
    if (base && withheld.contains(model::axis(*base))) continue;
    values.push_back({fit.numbers[j].name, value(fit.hypothesis, fit.numbers[j]), sigma[static_cast<Eigen::Index>(j)],
                      fit.numbers[j].unit});
  }
  return values;
}

bool names_claim(Verdict verdict) { return verdict == Verdict::effect || verdict == Verdict::ambiguous; }

std::vector<std::size_t> surest_first(const inference::Found& found) {
  std::vector<std::size_t> order(std::min(found.odds.size(), found.best.fit.hypothesis.model.effects.size()));
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t e) { return found.odds[e]; });
  return order;
}

void list_effects(const Conclusion& conclusion, const likelihood::Fit& fit, const Eigen::VectorXd& sigma, bool in_model,
                  DiagnosisResult& result) {
  const inference::Found& found = conclusion.found;
  const auto& effects = fit.hypothesis.model.effects;
  std::vector<std::size_t> order = surest_first(found);
  if (!names_claim(conclusion.verdict)) std::ranges::sort(order);
  std::erase_if(order, [&](std::size_t e) { return e >= effects.size(); });
  for (const std::size_t e : order) {
    const std::string name{effects[e].effect->name()}, &form = effects[e].variant_name;
    if (!names_claim(conclusion.verdict)) {
      result.stand_ins.push_back({name, form, in_model, found.size[e], found.over[e], conclusion.modulation[e].depth,
                                  numbers_of_effect(fit, e, sigma)});
      result.candidates.push_back({name, form, found.odds[e], "stand-in"});
      continue;
    }
    EffectFound effect{.name = name,
                       .variant = form,
                       .parameters = numbers_of_effect(fit, e, sigma),
                       .log_odds = found.odds[e],
                       .probability = found.probability[e] * found.reliability[e],
                       .sentence = std::string(effects[e].effect->sentence())};
    if (!found.rival[e].empty() && found.probability[e] < inference::Thresholds{}.name_probability)
      effect.alternatives.push_back(
          {.name = found.rival[e],
           .log_odds = std::log(found.probability[e] / std::max(1.0 - found.probability[e], 1e-300))});
    result.candidates.push_back({name, form, effect.log_odds, "accepted"});
    result.effects.push_back(std::move(effect));
  }
}

std::optional<std::pair<model::ActiveEffect, model::ActiveEffect>> rivals_in(const Conclusion& conclusion,
                                                                             const likelihood::Fit& named) {
  const inference::Found& found = conclusion.found;
  const auto& effects = named.hypothesis.model.effects;
  for (std::size_t e = 0; e < effects.size() && e < found.rival.size(); ++e) {
    if (found.rival[e].empty() || found.probability[e] >= inference::Thresholds{}.name_probability) continue;
    for (const inference::Fitted& near : found.near) {
      for (const model::ActiveEffect& other : near.fit.hypothesis.model.effects) {
        if (other.effect->name() == found.rival[e]) return std::pair{effects[e], other};
      }
    }
  }
  return {};
}

void list_refused(const inference::Found& found, DiagnosisResult& result, VerdictGiven& given) {
  for (const inference::Refused& refused : found.refused) {
    CandidateTried candidate{.name = refused.name, .variant = refused.form, .log_odds = kNotAsked};
    for (const inference::Refusal& refusal : refused.refusals) {
      given.refusals[refused.name].push_back({std::string(word(refusal.rule)), refusal.value, refusal.needed});
      if (refusal.rule == inference::Rule::kOdds && std::isfinite(refusal.value)) candidate.log_odds = refusal.value;
      candidate.reason += (candidate.reason.empty() ? "" : "; ") + sentence(refusal);
    }
    result.candidates.push_back(std::move(candidate));
  }
}

void list_not_asked(const model::Scene& scene, DiagnosisResult& result) {
  const std::vector<inference::Law> laws = inference::catalogue(scene, {});
  for (const model::Effect* effect : model::all_effects()) {
    const std::string name{effect->name()};
    if (std::ranges::find(laws, name, &inference::Law::name) != laws.end()) continue;
    result.candidates.push_back(
        {.name = name, .log_odds = kNotAsked, .reason = preflight::why_not_asked(*effect, scene)});
  }
}

}  // namespace fathom::verdict

#include "common/diagnosis/listing.hpp"

#include <algorithm>

#include "common/diagnosis/acting_order.hpp"
#include "common/diagnosis/judgement.hpp"
#include "common/diagnosis/left_over.hpp"
#include "common/diagnosis/moved.hpp"
#include "common/diagnosis/rivals.hpp"
#include "common/preflight/applicability.hpp"

namespace fathom::diagnosis {
namespace {

constexpr const char* kLast = " It acts on the thrust that the others leave, not on the command.";
constexpr double kEven = 0.0;  // log odds against something unlisted that looks the same

/// Numbers of one accepted effect, under names that stay apart when it was accepted in several forms.
std::vector<NamedValue> numbers_of(const Judged& judged, const SearchResult& found, bool several) {
  std::vector<NamedValue> values;
  const std::vector<NamedValue> all = found.after.parameters();
  std::size_t place = all.size();
  for (auto effect = found.after.model.effects.rbegin(); effect != found.after.model.effects.rend(); ++effect) {
    place -= effect->theta.size();
    if (effect->effect != judged.effect || effect->variant != judged.variant) continue;
    for (std::size_t i = 0; i < effect->theta.size(); ++i) {
      if (!judged.effect->is_told(judged.variant, i)) continue;
      NamedValue value = all[place + i];
      const std::string own{judged.effect->parameters()[i].name};
      value.name = judged.variant_name.empty() || !several ? own : judged.variant_name + "." + own;
      values.push_back(value);
    }
  }
  return values;
}

std::string either(const std::string& form, const std::string& other) {
  const auto told = [](const std::string& name) { return name.empty() ? std::string("the plain form") : name; };
  return told(form) + " or " + told(other);
}

/// What acts itself is no alternative to another.
std::vector<Alternative> alternatives_of(const Judged& judged, const SearchResult& found) {
  std::vector<Alternative> open = judged.alternatives;
  std::erase_if(open, [&](const Alternative& one) {
    return std::ranges::any_of(found.accepted, [&](const Judged& other) { return other.effect->name() == one.name; });
  });
  return open;
}

/// With the numbers that the effect has in the end.
model::Unlisted unlisted_for(const Judged& judged, const SearchResult& found, const model::Scene& scene) {
  for (const model::ActiveEffect& active : found.after.model.effects) {
    if (active.effect == judged.effect && active.variant == judged.variant)
      return active.effect->looks_like(active.theta, active.variant, scene);
  }
  return {};
}

}  // namespace

void list_effects(const SearchResult& found, double share, const model::Scene& scene, DiagnosisResult& result) {
  for (const Judged& judged : found.accepted) {
    const std::string name{judged.effect->name()};
    const std::vector<Alternative> alternatives = alternatives_of(judged, found);
    const model::Unlisted unlisted = unlisted_for(judged, found, scene);
    double log_odds = at_most_for(share, log_odds_among(judged.log_odds, alternatives));
    if (!unlisted.what.empty()) log_odds = std::min(log_odds, kEven);
    const auto forms = std::count_if(found.accepted.begin(), found.accepted.end(),
                                     [&](const Judged& j) { return j.effect == judged.effect; });
    const std::vector<NamedValue> numbers = numbers_of(judged, found, judged.effect->variants_matter() || forms > 1);
    const auto known = std::find_if(result.effects.begin(), result.effects.end(),
                                    [&](const EffectFound& e) { return e.name == name; });
    if (known != result.effects.end()) {
      if (known->unlisted.empty()) {
        known->unlisted = unlisted.what;
        known->unlisted_told_by = unlisted.told_by;
      }
      known->variant += ", " + judged.variant_name;
      known->parameters.insert(known->parameters.end(), numbers.begin(), numbers.end());
      known->log_odds = std::max(known->log_odds, log_odds);
      known->error_reduction = 1.0 - (1.0 - known->error_reduction) * (1.0 - judged.error_reduction);
      for (const Alternative& other : alternatives) {
        if (std::ranges::find(known->alternatives, other.name, &Alternative::name) == known->alternatives.end())
          known->alternatives.push_back(other);
      }
      for (const std::string& other : judged.other_forms)
        known->other_forms.push_back(either(judged.variant_name, other));
      continue;
    }
    const bool last = acts_last(found.after.model, judged);
    std::vector<std::string> other_forms;
    for (const std::string& other : judged.other_forms) other_forms.push_back(either(judged.variant_name, other));
    result.effects.push_back({.name = name,
                              .variant = judged.variant_name,
                              .accepted = true,
                              .parameters = numbers,
                              .log_odds = log_odds,
                              .error_reduction = judged.error_reduction,
                              .alternatives = alternatives,
                              .other_forms = other_forms,
                              .sentence = std::string(judged.effect->sentence()) + (last ? kLast : ""),
                              .unlisted = std::string(unlisted.what),
                              .unlisted_told_by = std::string(unlisted.told_by),
                              .corrupts = judged.corrupts,
                              .corruption = judged.corruption,
                              .last = last});
  }
}

std::size_t list_candidates(const SearchResult& found, const model::Scene& scene, DiagnosisResult& result) {
  for (const EffectFound& effect : result.effects) {
    std::vector<std::string> aliases;
    for (const Judged& judged : found.accepted) {
      if (judged.effect->name() == effect.name)
        aliases.insert(aliases.end(), judged.aliased_with.begin(), judged.aliased_with.end());
    }
    result.candidates.push_back(
        {effect.name, effect.variant, effect.log_odds, effect.error_reduction, aliases, "accepted"});
  }
  for (const Judged& judged : found.refused) {
    const std::string name{judged.effect->name()};
    const bool listed = std::any_of(result.candidates.begin(), result.candidates.end(),
                                    [&](const CandidateTried& c) { return c.name == name; });
    if (listed) continue;
    std::string reason = judged.reason;
    if (reason.empty()) reason = kWeaker;
    result.candidates.push_back(
        {name, judged.variant_name, judged.log_odds, judged.error_reduction, judged.aliased_with, reason});
  }
  const std::size_t asked = result.candidates.size();
  for (const model::Effect* effect : model::all_effects()) {
    const std::string name{effect->name()};
    const bool listed = std::any_of(result.candidates.begin(), result.candidates.end(),
                                    [&](const CandidateTried& c) { return c.name == name; });
    if (!listed) result.candidates.push_back({name, "", 0.0, 0.0, {}, why_not_asked(*effect, scene)});
  }
  return asked;
}

}  // namespace fathom::diagnosis

#include "common/verdict/next_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "common/model/candidates/column_effect.hpp"
#include "common/model/effect.hpp"

namespace fathom::verdict {
namespace {

constexpr double kKnown = 0.1;  // standard deviation over size: better known than that, nothing is open

std::string motion_for(const std::string& name) {
  if (name.starts_with("column ")) return std::string{model::kShowsColumn};
  const model::Effect* effect = model::find_effect(name);
  return effect != nullptr ? std::string{effect->revealed_by()} : std::string{};
}

std::string joined(const std::vector<std::string>& words, const std::string& between, const std::string& last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? last : between) + words[i];
  return text;
}

std::string between_rivals(const EffectFound& effect) {
  std::vector<std::string> names, motions{motion_for(effect.name)};
  for (const Alternative& other : effect.alternatives) {
    names.push_back(other.name);
    const std::string motion = motion_for(other.name);
    if (std::ranges::find(motions, motion) == motions.end()) motions.push_back(motion);
  }
  std::erase(motions, "");
  return "To tell " + effect.name + " from " + joined(names, ", ", " and ") + ": " + joined(motions, "; ", "; and ") +
         ".";
}

/// Where something acts that has no name: what separates its arguments.
std::string for_the_unlisted(const std::string& verdict) {
  if (verdict == "unexplained")
    return "Fly the same steps once more, later, at another place and in another order: what goes with the motion "
           "comes "
           "back as it was, what goes with the place or with time does not.";
  if (verdict == "no_model")
    return "Drive one axis at a time, from rest, with steps of thrust ahead and astern, so that it shows which thrust "
           "the motion does not follow.";
  return {};
}

}  // namespace

std::string next_motion(const DiagnosisResult& result) {
  if (result.wiring) return "Run each thruster alone for a second or two and see which way the vehicle goes.";
  const std::string unlisted = for_the_unlisted(result.verdict);
  const EffectFound* weakest = nullptr;
  const NamedValue* number = nullptr;
  double share = kKnown;
  for (const EffectFound& effect : result.effects) {
    if (!effect.alternatives.empty()) return between_rivals(effect) + (unlisted.empty() ? "" : " " + unlisted);
    for (const NamedValue& one : effect.parameters) {
      const double its = one.value != 0.0 ? one.std / std::abs(one.value) : 0.0;
      if (!(its > share) || !std::isfinite(its)) continue;
      weakest = &effect;
      number = &one;
      share = its;
    }
  }
  if (!unlisted.empty()) return unlisted;
  if (weakest == nullptr || motion_for(weakest->name).empty()) return {};
  char known[32];
  std::snprintf(known, sizeof known, "%.0f %%", 100.0 * share);
  return "To know " + weakest->name + " better (its " + number->name + " is known to " + known +
         "): " + motion_for(weakest->name) + ".";
}

}  // namespace fathom::verdict

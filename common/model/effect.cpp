#include "common/model/effect.hpp"

#include <algorithm>
#include <array>
#include <numbers>

namespace fathom::model {

namespace effects {
#define EFFECT(name) const Effect& name();
#include "common/model/effects/effects.def"
#undef EFFECT
}  // namespace effects

std::span<const Effect* const> all_effects() {
#define EFFECT(name) &effects::name(),
  static const std::array kEffects{
#include "common/model/effects/effects.def"
  };
#undef EFFECT
  return kEffects;
}

bool changes_thrust(const Effect& effect) {
  const auto all = all_effects();
  return std::ranges::find(all, &effect) < std::ranges::find(all, &effects::current());
}

const Effect* find_effect(std::string_view name) {
  for (const Effect* effect : all_effects()) {
    if (effect->name() == name) return effect;
  }
  return nullptr;
}

int Effect::numbers(int variant) const {
  int count = 0;
  for (std::size_t i = 0; i < parameters().size(); ++i) count += takes_part(variant, i) ? 1 : 0;
  return count;
}

std::vector<std::vector<double>> Effect::starts(const Scene&, int) const {
  std::vector<double> start;
  for (const EffectParameter& parameter : parameters()) start.push_back(0.1 * parameter.sigma);
  return {start};
}

double run_in_for(double time_constant) {
  constexpr double kShortest = 3.0, kLongest = 48.0, kConstants = 4.5;  // s, s; 1 % is forgotten at most
  double seconds = kShortest;
  while (seconds < kConstants * time_constant && seconds < kLongest) seconds *= std::numbers::sqrt2;
  return seconds;
}

}  // namespace fathom::model

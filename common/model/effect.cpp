#include "common/model/effect.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "common/model/one_of_many.hpp"

namespace fathom::model {

namespace effects {
#define EFFECT(name) const Effect& name();
#include "common/model/effects/effects.def"
#undef EFFECT
}  // namespace effects

namespace {

auto in_acting_order() {
#define EFFECT(name) &effects::name(),
  std::array all{
#include "common/model/effects/effects.def"
  };
#undef EFFECT
  std::ranges::stable_sort(all, {}, [](const Effect* effect) { return effect->traits().stage; });
  return all;
}

}  // namespace

std::span<const Effect* const> all_effects() {
  static const auto kEffects = in_acting_order();
  return kEffects;
}

const Effect* find_effect(std::string_view name) {
  for (const Effect* effect : all_effects()) {
    if (effect->name() == name) return effect;
  }
  return nullptr;
}

Effect::Effect(Traits traits, std::span<const EffectParameter> parameters, Forms forms)
    : traits_{traits}, parameters_{parameters.begin(), parameters.end()}, forms_{std::move(forms)} {
  for (const auto& form : forms_) form->parameters_ = parameters_;
}

std::vector<std::string> Effect::variants(const Scene& scene) const {
  std::vector<std::string> names;
  for (const auto& form : forms_) names.push_back(form->name(scene).value_or("-"));
  if (std::ranges::all_of(names, [](const std::string& name) { return name == "-"; })) return {};
  const auto beyond = [&](std::size_t place) {
    const auto* one = dynamic_cast<const OneOfMany*>(forms_[place].get());
    return one != nullptr && !one->exists(scene);
  };
  while (beyond(names.size() - 1)) names.pop_back();
  return names;
}

bool Effect::rules_out(int variant, int other) const {
  if (variant == other) return true;
  const int obeys = form(variant).traits().obeys;
  return obeys >= 0 && obeys == form(other).traits().obeys;
}

std::string_view Effect::unit(int variant, std::size_t number) const {
  const auto leading = static_cast<std::size_t>(std::max(traits_.amplitudes, 1));
  const FormTraits& of_form = form(variant).traits();
  return number < leading && of_form.unit ? *of_form.unit : parameters_[number].unit;
}

std::vector<std::size_t> Effect::sought(int variant) const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    if (takes_part(variant, i)) places.push_back(i);
  return places;
}

int Effect::numbers(int variant) const { return static_cast<int>(sought(variant).size()); }

Starts Form::starts(const Scene&) const {
  std::vector<double> start;
  for (const EffectParameter& parameter : parameters_) start.push_back(0.1 * parameter.sigma);
  return {start};
}

double run_in_for(double time_constant) {
  constexpr double kShortest = 3.0, kLongest = 48.0, kConstants = 4.5;  // s, s; 1 % is forgotten at most
  double seconds = kShortest;
  while (seconds < kConstants * time_constant && seconds < kLongest) seconds *= std::numbers::sqrt2;
  return seconds;
}

}  // namespace fathom::model

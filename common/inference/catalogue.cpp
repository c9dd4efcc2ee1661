#include "common/inference/catalogue.hpp"

#include <algorithm>

#include "common/model/effect_size.hpp"
#include "common/model/onset.hpp"

namespace fathom::inference {

std::vector<std::string> listed_names() {
  std::vector<std::string> names;
  for (const model::Effect* effect : model::all_effects()) names.emplace_back(effect->name());
  return names;
}

bool moves(const model::ActiveEffect& active, std::size_t number) {
  return active.effect->takes_part(active.variant, number);
}

bool stopped(const model::ActiveEffect& active, const model::Scene& scene) {
  return model::stopped_at_limit(*active.effect, active.variant, active.theta, *scene.vehicle) ||
         !active.effect->possible(active.theta, active.variant, scene);
}

bool asked_first(const Law& law) { return law.seed.effect->traits().asked_first; }

bool by_nature(const model::ActiveEffect& active) { return active.effect->traits().own_flow; }

bool by_nature(const std::string& name) {
  const model::Effect* effect = model::find_effect(name);
  return effect != nullptr && effect->traits().own_flow;
}

std::size_t claims(const std::vector<model::ActiveEffect>& effects) {
  return static_cast<std::size_t>(
      std::ranges::count_if(effects, [](const auto& active) { return !by_nature(active); }));
}

bool exclude(const model::ActiveEffect& a, const model::ActiveEffect& b) {
  return a.effect == b.effect && (!a.effect->variants_matter() || a.effect->rules_out(a.variant, b.variant));
}

std::vector<Law> catalogue(const model::Scene& scene, const std::vector<std::string>& without) {
  std::vector<Law> laws;
  std::vector<const model::Effect*> all{model::all_effects().begin(), model::all_effects().end()};
  all.insert(all.end(), scene.candidates.begin(), scene.candidates.end());
  for (const model::Effect* effect : all) {
    if (std::ranges::find(without, effect->name()) != without.end()) continue;
    const std::vector<std::string> forms = effect->variants(scene);
    const std::size_t first = laws.size();
    for (std::size_t v = 0; v < forms.size(); ++v) {
      if (forms[v] == "-") continue;
      const auto variant = static_cast<int>(v);
      Law law{.name = std::string(effect->name()), .form = forms[v]};
      law.grid = effect->starts(scene, variant);
      if (law.grid.empty()) continue;
      law.seed = {.effect = effect, .variant = variant, .variant_name = forms[v], .theta = law.grid.front()};
      const std::size_t leading =
          effect->amplitudes() > 0 ? static_cast<std::size_t>(effect->amplitudes()) : effect->parameters().size();
      for (std::size_t c = 0; c < effect->parameters().size(); ++c) {
        if (effect->parameters()[c].name == model::kOnset) law.onset = static_cast<int>(c);
        if (c < leading && effect->takes_part(variant, c)) law.linear.push_back(c);
      }
      if (!law.linear.empty()) laws.push_back(std::move(law));
    }
    for (std::size_t l = first; l < laws.size(); ++l) laws[l].forms = static_cast<int>(laws.size() - first);
  }
  return laws;
}

}  // namespace fathom::inference

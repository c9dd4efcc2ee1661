#include "processes/fathom/separations.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "common/model/effect.hpp"
#include "common/model/rollout.hpp"
#include "common/planning/flights.hpp"
#include "common/planning/separation.hpp"
#include "common/residual/prediction.hpp"

namespace fathom::tool {
namespace {

constexpr double kWindow = 10.0;  // s, as in a diagnosis

/// Of the base parameters alone: the effects stand beside it as suspects.
model::Model bare(model::Model model) {
  model.effects.clear();
  return model;
}

/// What the model leaves, m/s and rad/s: by its open-loop errors over such windows, or what the sensors scatter by.
Vector6d left_by(const model::Model& model, std::span<const Trial> trials) {
  Vector6d sigma = trials.front().nu_sigma;
  const auto windows = residual::prediction_windows(trials);
  if (windows.empty()) return sigma;
  const PredictionError last = residual::predict(model, windows).summary(*model.vehicle).back();
  for (std::size_t axis = 0; axis < 6; ++axis) {
    double& of = sigma[static_cast<Eigen::Index>(axis)];
    if (std::isfinite(last.rmse[axis])) of = std::max(of, last.rmse[axis]);
  }
  return sigma;
}

std::string sentence(const EffectFound& effect) {
  std::string text;
  char number[32];
  for (const ToldApart& other : effect.told_apart) {
    std::snprintf(number, sizeof number, "%.0f s", other.seconds);
    text += (text.empty() ? "To tell " + effect.name + " from " : ", from ") + other.name + ": " + number + " of " +
            other.segment;
  }
  return text.empty() ? "" : text + " (computed inside the site's fence).";
}

}  // namespace

void separate(const model::Vehicle& vehicle, const planning::RehearsalSettings& settings, std::span<const Trial> train,
              const model::Model& best, DiagnosisResult& result) {
  const bool open = std::ranges::any_of(result.effects, [](const EffectFound& e) { return !e.alternatives.empty(); });
  if (!open || train.empty()) return;
  const planning::View data{vehicle, {train.begin(), train.end()}, bare(best), left_by(best, train), kWindow};
  const model::Scene scene = model::scene_of(vehicle, train);
  const planning::Flights flights{vehicle, data, settings};
  std::string proposal;
  for (EffectFound& effect : result.effects) {
    const auto active = std::ranges::find_if(
        best.effects, [&](const model::ActiveEffect& a) { return a.effect->name() == effect.name; });
    if (active == best.effects.end()) continue;
    for (const auto& [other, log_odds] : effect.alternatives) {
      const model::Effect* listed = model::find_effect(other);
      if (listed == nullptr || model::find_effect(effect.name) == nullptr)
        continue;  // a column, which no flight changes
      const auto answer = planning::segment_between(*active, *listed, scene, data, flights.extras());
      if (answer) effect.told_apart.push_back({other, answer->segment, answer->seconds});
    }
    if (proposal.empty()) proposal = sentence(effect);
  }
  if (!proposal.empty()) result.manoeuvre = proposal;
}

}  // namespace fathom::tool

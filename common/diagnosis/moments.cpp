#include "common/diagnosis/moments.hpp"

#include <algorithm>

#include "common/model/onset.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kWindows = 2.0;  // how far to look to either side
constexpr double kStep = 0.5;     // s: from there the fit finds its way

double* onset_in(model::Model& model, const model::Effect& effect, int variant) {
  const auto parameters = effect.parameters();
  const auto place = std::ranges::find(parameters, model::kOnset, &model::EffectParameter::name);
  if (place == parameters.end()) return nullptr;
  for (model::ActiveEffect& active : model.effects) {
    if (active.effect == &effect && active.variant == variant)
      return &active.theta[static_cast<std::size_t>(place - parameters.begin())];
  }
  return nullptr;
}

}  // namespace

identification::FitResult at_best_moment(const identification::TrajectoryFit& problem, identification::FitResult fit,
                                         const model::Effect& effect, int variant) {
  model::Model model = fit.model;
  double* onset = onset_in(model, effect, variant);
  if (onset == nullptr) return fit;
  const double found = *onset, reach = kWindows * problem.settings().window;
  double best = found, lowest = fit.cost;
  for (double moment = std::max(found - reach, 0.0); moment <= found + reach; moment += kStep) {
    *onset = moment;
    const double cost = problem.cost(model, fit);
    if (cost >= lowest) continue;
    lowest = cost;
    best = moment;
  }
  if (best == found) return fit;
  *onset = best;
  identification::FitResult moved = problem.fit(model, &fit);
  return moved.cost < fit.cost ? moved : fit;
}

}  // namespace fathom::diagnosis

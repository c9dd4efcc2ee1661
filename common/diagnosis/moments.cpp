#include "common/diagnosis/moments.hpp"

#include <algorithm>
#include <limits>

#include "common/model/onset.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kFine = 0.5;    // s between moments: from there the fit finds its way
constexpr double kCoarse = 5.0;  // s, all over the data and then to either side of the best
constexpr int kRounds = 3;       // what a fit changes at a better moment may make another one better

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
  double first = std::numeric_limits<double>::infinity(), last = 0.0;
  for (const auto& residual : problem.windows()) {
    const model::Window& window = residual.window();
    first = std::min(first, window.trial->t[window.start]);
    last = std::max(last, window.trial->t[window.start + window.count - 1]);
  }
  for (int round = 0; round < kRounds; ++round) {
    model::Model model = fit.model;
    double* onset = onset_in(model, effect, variant);
    if (onset == nullptr) return fit;
    const double found = *onset;
    double best = found, lowest = fit.cost;
    const auto look = [&](double from, double to, double step) {
      for (double moment = std::max(from, first); moment <= std::min(to, last); moment += step) {
        *onset = moment;
        const double cost = problem.cost(model, fit);
        if (cost >= lowest) continue;
        lowest = cost;
        best = moment;
      }
    };
    if (round == 0) look(first, last, kCoarse);
    look(best - kCoarse, best + kCoarse, kFine);
    if (best == found) return fit;
    *onset = best;
    identification::FitResult moved = problem.fit(model, &fit);
    if (moved.cost >= fit.cost) return fit;
    fit = std::move(moved);
  }
  return fit;
}

}  // namespace fathom::diagnosis

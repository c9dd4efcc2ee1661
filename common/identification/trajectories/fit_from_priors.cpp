#include "common/identification/trajectories/fit_from_priors.hpp"

#include <algorithm>
#include <utility>

namespace fathom::identification {
namespace {

constexpr std::size_t kCoarseWindows = 80;      // enough to come near; the last stage uses all
constexpr double kOutOfProportion = 20.0;       // to either side of what the vehicle's file says
constexpr double kShortest = 0.2, kHalf = 0.5;  // of a window

/// Masses and inertias that are out of proportion take the expected value; false when there is none.
bool set_right(model::Model& model) {
  const ParameterMap map{model};
  bool any = false;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i].base < 0 || !(map[i].low > 0.0)) continue;  // only what must be positive
    double& value = model.theta[map[i].base];
    const double expected = map[i].prior_mean > 0.0 ? map[i].prior_mean : map[i].prior_sigma;
    if (value > expected / kOutOfProportion && value < expected * kOutOfProportion) continue;
    value = expected;
    any = true;
  }
  return any;
}

/// Of a stage that only has to come near.
FitSettings stage_of(const FitSettings& settings, double share_of_window) {
  FitSettings stage = settings;
  stage.window = share_of_window * settings.window;
  stage.iterations = 8;
  stage.tolerance = 1e-3;
  stage.most_windows = std::min(kCoarseWindows, settings.most_windows);
  return stage;
}

}  // namespace

FitResult with_plausible_masses(const TrajectoryFit& problem, FitResult fit) {
  model::Model model = fit.model;
  if (!set_right(model)) return fit;
  const FitResult again = problem.fit(model, &fit);  // by the same weights
  return again.cost < fit.cost ? problem.fit(again.model) : fit;
}

TrajectoryFit shortest_windows(const model::Vehicle& vehicle, std::span<const Trial> trials,
                               const FitSettings& settings) {
  return {vehicle, trials, stage_of(settings, kShortest)};
}

FitResult fit_by_longer_windows(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                const FitSettings& settings, const model::Model& start) {
  const TrajectoryFit half{vehicle, trials, stage_of(settings, kHalf)};
  const FitResult nearer = with_plausible_masses(half, half.fit(start));
  const TrajectoryFit whole{vehicle, trials, settings};
  return with_plausible_masses(whole, whole.fit(nearer.model));
}

FitResult fit_from_priors(const model::Vehicle& vehicle, std::span<const Trial> trials, const FitSettings& settings) {
  const TrajectoryFit shortest = shortest_windows(vehicle, trials, settings);
  model::Model model = model::nominal_model(vehicle, trials[0].input_is_wrench);
  const FitResult straight = shortest.fit(model);
  FitResult best = straight;
  // A vehicle that answers faster than it is commanded looks all wrong under a wrong hold, and no step leads out.
  for (const double hold : {-0.5, 0.5}) {
    model.input_hold = hold;
    FitResult held = shortest.fit(model, &straight);
    if (held.cost < best.cost) best = std::move(held);
  }
  return fit_by_longer_windows(vehicle, trials, settings, best.model);
}

}  // namespace fathom::identification

#include "common/diagnosis/final_fit.hpp"

#include <algorithm>
#include <utility>

#include "common/identification/pose_fit.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kAstray = 3.0;   // times the cost that short windows need: what a model lacks costs less than that
constexpr double kShorter = 0.5;  // of a window that misled
constexpr double kLong = 3.0;     // windows, where nothing but forces moves the model

}  // namespace

Everything fit_everything(const model::Vehicle& vehicle, std::span<const Trial> train, const Settings& settings,
                          const NearView& near, const model::Model& found) {
  identification::FitSettings fits = settings.fit;
  const double shortest = near.problem.settings().window;
  const model::Model* start = &found;
  for (;; fits.window = std::max(kShorter * fits.window, shortest)) {
    identification::TrajectoryFit problem{vehicle, train, fits};
    identification::FitResult fit = problem.fit(*start);
    const bool astray = near.problem.cost(fit.model, near.reference) > kAstray * near.reference.cost;
    if (!astray || fits.window <= shortest) return {std::move(problem), std::move(fit)};
    start = &near.reference.model;
  }
}

std::optional<identification::FitResult> with_poses(const model::Vehicle& vehicle, std::span<const Trial> train,
                                                    const Settings& settings, double window,
                                                    const identification::FitResult& by_speeds) {
  // Axes that are left out follow what was measured, and the noise of that adds up in the others like unknown forces.
  const bool all = std::ranges::all_of(vehicle.dof, [](bool simulated) { return simulated; });
  return identification::fit_with_poses(
      vehicle, train, {.window = all ? kLong * window : window, .block = window, .threads = settings.fit.threads},
      by_speeds);
}

}  // namespace fathom::diagnosis

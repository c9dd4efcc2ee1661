#include "common/diagnosis/final_fit.hpp"

#include <algorithm>
#include <utility>

namespace fathom::diagnosis {
namespace {

constexpr double kAstray = 3.0;   // times the cost that short windows need: what a model lacks costs less than that
constexpr double kShorter = 0.5;  // of a window that misled

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

}  // namespace fathom::diagnosis

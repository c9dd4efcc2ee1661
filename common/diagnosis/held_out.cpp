#include "common/diagnosis/held_out.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fathom::diagnosis {
namespace {

constexpr int kFolds = 5;
constexpr std::size_t kFoldBlock = 3;  // windows that stay together, so that held-out data is not a neighbour's echo
constexpr std::size_t kFewestRuns = 3;

/// Products of one window: residual without the effect (r) and the effect's direction (d).
struct Products {
  double rr{}, dr{}, dd{};
};

std::vector<int> folds_by_block(std::size_t windows) {
  std::vector<int> folds(windows);
  for (std::size_t w = 0; w < windows; ++w) folds[w] = static_cast<int>((w / kFoldBlock) % kFolds);
  return folds;
}

std::vector<int> folds_by_run(std::span<const identification::WindowResidual> windows) {
  std::vector<int> folds;
  std::vector<const Trial*> runs;
  for (const auto& window : windows) {
    const auto place = std::find(runs.begin(), runs.end(), window.window().trial);
    folds.push_back(static_cast<int>(place - runs.begin()));
    if (place == runs.end()) runs.push_back(window.window().trial);
  }
  return runs.size() >= kFewestRuns ? folds : folds_by_block(windows.size());
}

double saved(const std::vector<Products>& windows, const std::vector<int>& folds, double prior) {
  const int count = *std::max_element(folds.begin(), folds.end()) + 1;
  double before = 0.0, after = 0.0;
  for (int fold = 0; fold < count; ++fold) {
    double dr = 0.0, dd = prior;
    for (std::size_t w = 0; w < windows.size(); ++w) {
      if (folds[w] == fold) continue;
      dr += windows[w].dr;
      dd += windows[w].dd;
    }
    const double amplitude = dd > 0.0 ? -dr / dd : 0.0;
    for (std::size_t w = 0; w < windows.size(); ++w) {
      if (folds[w] != fold) continue;
      before += windows[w].rr;
      after += windows[w].rr + 2.0 * amplitude * windows[w].dr + amplitude * amplitude * windows[w].dd;
    }
  }
  return before > 0.0 ? 1.0 - std::sqrt(std::max(after, 0.0) / before) : 0.0;
}

}  // namespace

HeldOut held_out(const identification::TrajectoryFit& problem, const identification::FitResult& without,
                 const identification::FitResult& with, std::span<const double> sizes) {
  std::vector<Products> windows;
  model::VelocityTrace trace;
  double scatter = 0.0, information = 0.0;
  std::array<double, 6> moved_square{}, measured_square{};
  for (std::size_t w = 0; w < problem.windows().size(); ++w) {
    const auto& window = problem.windows()[w];
    Eigen::VectorXd r(window.rows()), moved(window.rows());
    window.evaluate(without.model, without.nu0[w], without.sigma, trace, r);
    window.evaluate(with.model, with.nu0[w], without.sigma, trace, moved);
    // A window of outliers (a glitch, a collision) counts as in the fit: no more than one at the outlier bound.
    const double weight = std::min(1.0, 2.0 * without.window_cost[w] / std::max(r.squaredNorm(), 1e-300));
    const Eigen::VectorXd d = moved - r;
    for (Eigen::Index i = 0; i < d.size(); ++i) {
      const auto axis = static_cast<std::size_t>(window.axis(i));
      const double sigma = without.sigma[window.axis(i)];
      moved_square[axis] += sigma * sigma * d[i] * d[i];
      measured_square[axis] += window.measured(i) * window.measured(i);
    }
    windows.push_back({weight * r.squaredNorm(), weight * d.dot(r), weight * d.squaredNorm()});
    scatter += windows.back().dr * windows.back().dr;
    information += windows.back().dd;
  }
  // Correlated residuals overstate the information by this factor; against the prior it must not count.
  const double inflation = information > 0.0 ? std::max(1.0, scatter / information) : 1.0;
  double square = 0.0;
  for (const double size : sizes) square += size * size;
  double change = 0.0;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (measured_square[axis] > 0.0) change = std::max(change, std::sqrt(moved_square[axis] / measured_square[axis]));
  }
  return {saved(windows, folds_by_block(windows.size()), inflation * square),
          saved(windows, folds_by_run(problem.windows()), inflation * square), change};
}

}  // namespace fathom::diagnosis

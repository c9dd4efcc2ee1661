#include "common/diagnosis/bent_base.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/diagnosis/moved.hpp"
#include "common/identification/parameter_map.hpp"
#include "common/residual/force_residual.hpp"
#include "common/residual/prediction.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kBent = 3.0;            // standard deviations by which a fit may be bent, ordinarily
constexpr int kRounds = 3;               // of weights by what is left
constexpr double kSmallestSize = 1e-12;  // N, N m: an axis without residual

/// Samples that share no measurement, axis by axis.
Eigen::VectorXd stacked(std::span<const Trial> trials, std::span<const std::vector<Vector6d>> residuals) {
  std::vector<double> all;
  for (std::size_t r = 0; r < trials.size(); ++r) {
    const std::size_t span = residual_span(trials[r].dt);
    for (std::size_t k = span / 2; k < residuals[r].size(); k += span)
      all.insert(all.end(), residuals[r][k].begin(), residuals[r][k].end());
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

/// The runs as the model foretells them from one start to the next: what goes with the sensors' noise is not in them.
/// Starts are measured, so nothing is told of the spans that hold one.
std::vector<Trial> foretold(const model::Model& model, std::span<const Trial> trials) {
  std::vector<Trial> runs(trials.begin(), trials.end());
  for (Trial& run : runs) {
    const std::vector<std::size_t> starts = restarts(run);
    const auto nu = predict_anew(model, run, starts);
    for (std::size_t k = 0; k < nu.size(); ++k) {
      for (std::size_t axis = 0; axis < 6; ++axis) {
        if (!model.vehicle->dof[axis]) continue;
        if (std::isfinite(nu[k][axis])) {
          run.nu[k][static_cast<Eigen::Index>(axis)] = nu[k][axis];
        } else {
          run.velocity_valid[k] = run.rates_valid[k] = 0;
        }
      }
    }
    for (const std::size_t start : starts) run.velocity_valid[start] = run.rates_valid[start] = 0;
  }
  return runs;
}

/// Of each axis: one over the square that is left; none where nothing is measured.
Vector6d weights(const Eigen::VectorXd& left) {
  Vector6d square = Vector6d::Zero(), count = Vector6d::Zero();
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    if (!std::isfinite(left[i])) continue;
    square[i % 6] += left[i] * left[i];
    count[i % 6] += 1.0;
  }
  return (square.array() > kSmallestSize * kSmallestSize).select(count.cwiseQuotient(square.cwiseMax(1e-300)), 0.0);
}

}  // namespace

std::vector<std::vector<Vector6d>> residuals_unbent(const model::Model& model, std::span<const Trial> trials,
                                                    std::span<const NamedValue> fitted) {
  std::vector<std::vector<Vector6d>> residuals = wrench_residuals(model, trials);
  const Eigen::VectorXd target = stacked(trials, residuals);
  const identification::ParameterMap map{model};
  std::vector<std::size_t> base;
  std::vector<double> spread;  // of each, as a share of its scale
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i].base < 0 || !map[i].sought) continue;
    base.push_back(i);
    const bool known = i < fitted.size() && fitted[i].name == map[i].name && fitted[i].std > 0.0;
    spread.push_back((known ? std::min(kBent * fitted[i].std, map[i].prior_sigma) : map[i].prior_sigma) / map[i].scale);
  }
  // Least squares would call noise of the acceleration times mass a mass that is too large. Columns of the foretold
  // motion are blind to it: they choose which sums must vanish (instrumental variables; Soderstrom and Stoica 1983).
  const std::vector<Trial> smooth = foretold(model, trials);
  const Eigen::VectorXd smooth_target = stacked(smooth, wrench_residuals(model, smooth));
  Eigen::MatrixXd columns(target.size(), static_cast<Eigen::Index>(base.size())), instruments = columns;
  for (std::size_t j = 0; j < base.size(); ++j) {
    model::Model moved = model;  // the residual is linear in base numbers, so any step will do
    moved.theta[map[base[j]].base] += map[base[j]].scale;
    columns.col(static_cast<Eigen::Index>(j)) = stacked(trials, wrench_residuals(moved, trials)) - target;
    instruments.col(static_cast<Eigen::Index>(j)) = stacked(smooth, wrench_residuals(moved, smooth)) - smooth_target;
  }
  Eigen::VectorXd step = Eigen::VectorXd::Zero(columns.cols()), left = target;
  for (int round = 0; round < kRounds; ++round) {
    const Vector6d weight = weights(left);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
    Eigen::VectorXd right = Eigen::VectorXd::Zero(columns.cols());
    for (Eigen::Index i = 0; i < target.size(); ++i) {
      if (!std::isfinite(target[i]) || !instruments.row(i).allFinite()) continue;
      normal += weight[i % 6] * instruments.row(i).transpose() * columns.row(i);
      right -= weight[i % 6] * target[i] * instruments.row(i).transpose();
    }
    for (std::size_t j = 0; j < base.size(); ++j) {
      const auto k = static_cast<Eigen::Index>(j);
      normal(k, k) += 1.0 / (spread[j] * spread[j]);
    }
    step = normal.partialPivLu().solve(right);
    left = target + columns * step;
  }
  if (!step.allFinite()) return residuals;
  model::Model unbent = model;
  for (std::size_t j = 0; j < base.size(); ++j)
    unbent.theta[map[base[j]].base] += step[static_cast<Eigen::Index>(j)] * map[base[j]].scale;
  return wrench_residuals(unbent, trials);
}

}  // namespace fathom::diagnosis

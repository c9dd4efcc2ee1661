#include "common/diagnosis/bent_base.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "common/diagnosis/force_residual.hpp"
#include "common/identification/parameter_map.hpp"

namespace fathom::diagnosis {
namespace {

constexpr int kRounds = 3;               // of weights by what is left
constexpr double kSmallestSize = 1e-12;  // N, N m: an axis without residual

std::vector<std::vector<Vector6d>> residuals_of(const model::Model& model, std::span<const Trial> trials) {
  std::vector<std::vector<Vector6d>> residuals;
  for (const Trial& trial : trials) residuals.push_back(wrench_residuals(model, trial));
  return residuals;
}

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

std::vector<std::vector<Vector6d>> residuals_unbent(const model::Model& model, std::span<const Trial> trials) {
  std::vector<std::vector<Vector6d>> residuals = residuals_of(model, trials);
  const Eigen::VectorXd target = stacked(trials, residuals);
  const identification::ParameterMap map{model};
  std::vector<std::size_t> base;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i].base >= 0 && map[i].sought) base.push_back(i);
  }
  Eigen::MatrixXd columns(target.size(), static_cast<Eigen::Index>(base.size()));
  for (std::size_t j = 0; j < base.size(); ++j) {
    model::Model moved = model;  // the residual is linear in base numbers, so any step will do
    moved.theta[map[base[j]].base] += map[base[j]].scale;
    columns.col(static_cast<Eigen::Index>(j)) = stacked(trials, residuals_of(moved, trials)) - target;
  }
  Eigen::VectorXd step = Eigen::VectorXd::Zero(columns.cols()), left = target;
  for (int round = 0; round < kRounds; ++round) {
    const Vector6d weight = weights(left);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
    Eigen::VectorXd right = Eigen::VectorXd::Zero(columns.cols());
    for (Eigen::Index i = 0; i < target.size(); ++i) {
      if (!std::isfinite(target[i])) continue;
      normal += weight[i % 6] * columns.row(i).transpose() * columns.row(i);
      right -= weight[i % 6] * target[i] * columns.row(i).transpose();
    }
    for (std::size_t j = 0; j < base.size(); ++j) {
      const auto k = static_cast<Eigen::Index>(j);
      normal(k, k) += std::pow(map[base[j]].scale / map[base[j]].prior_sigma, 2);
    }
    step = normal.ldlt().solve(right);
    left = target + columns * step;
  }
  if (!step.allFinite()) return residuals;
  model::Model unbent = model;
  for (std::size_t j = 0; j < base.size(); ++j)
    unbent.theta[map[base[j]].base] += step[static_cast<Eigen::Index>(j)] * map[base[j]].scale;
  return residuals_of(unbent, trials);
}

}  // namespace fathom::diagnosis

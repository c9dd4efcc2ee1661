#include "common/diagnosis/screening.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace fathom::diagnosis {
namespace {

using identification::ProjectedWindow;

constexpr int kBestStarts = 2;
constexpr int kNewtonSteps = 4;
constexpr double kSmallStep = 1e-3;  // of the parameter's sigma or value, for differences
constexpr double kWorthValidating = 1e-3;  // share of the cost: less is refused whatever held-out data says
constexpr int kFolds = 5;
constexpr std::size_t kFewestRuns = 3;
constexpr std::size_t kFoldBlock = 3;  // windows that stay together, so that held-out data is not a neighbour's echo

/// Projected residuals of all windows with the candidate at theta, the base parameters unchanged.
class CandidateModel {
 public:
  CandidateModel(const Linearisation& base, const model::Effect& effect, int variant, const std::string& name)
      : base_{base}, model_{base.fit().model} {
    model_.add({&effect, variant, name, std::vector<double>(effect.parameters().size(), 0.0)});
    const auto place = std::find_if(model_.effects.begin(), model_.effects.end(), [&](const auto& active) {
      return active.effect == &effect && active.variant == variant;
    });
    theta_ = &place->theta;
  }

  Eigen::VectorXd residual(const std::vector<double>& theta) {
    *theta_ = theta;
    Eigen::VectorXd all(total_rows());
    Eigen::Index offset = 0;
    for (std::size_t w = 0; w < base_.windows().size(); ++w) {
      const auto& window = base_.problem().windows()[w];
      const ProjectedWindow& projected = base_.windows()[w];
      auto segment = all.segment(offset, window.rows());
      window.evaluate(model_, base_.fit().nu0[w], base_.fit().sigma, trace_, segment);
      // Windows beyond the outlier bound were weighted down; their base residual tells by how much.
      if (projected.initial_basis.cols() > 0) {
        segment -= projected.initial_basis * (projected.initial_basis.transpose() * segment).eval();
      } else {
        const double norm = segment.norm();
        if (norm > 0.0) segment *= std::min(1.0, projected.residual.norm() / norm);
      }
      offset += window.rows();
    }
    return all;
  }

  [[nodiscard]] Eigen::Index total_rows() const {
    Eigen::Index rows = 0;
    for (const auto& window : base_.problem().windows()) rows += window.rows();
    return rows;
  }

 private:
  const Linearisation& base_;
  model::Model model_;
  std::vector<double>* theta_{};
  model::VelocityTrace trace_;
};

/// b -> the part of b that base parameters cannot imitate.
void remove_base(const Linearisation& base, Eigen::MatrixXd& columns) {
  const auto n = base.windows()[0].jacobian.cols();
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(n, columns.cols());
  Eigen::Index offset = 0;
  for (const ProjectedWindow& window : base.windows()) {
    product += window.jacobian.transpose() * columns.middleRows(offset, window.jacobian.rows());
    offset += window.jacobian.rows();
  }
  const Eigen::MatrixXd step = base.solve(product);
  offset = 0;
  for (const ProjectedWindow& window : base.windows()) {
    columns.middleRows(offset, window.jacobian.rows()) -= window.jacobian * step;
    offset += window.jacobian.rows();
  }
}

std::vector<double> clamped(const model::Effect& effect, std::vector<double> theta) {
  const auto parameters = effect.parameters();
  for (std::size_t i = 0; i < theta.size(); ++i) theta[i] = std::clamp(theta[i], parameters[i].low, parameters[i].high);
  return theta;
}

std::vector<double> window_costs(const Linearisation& base, const Eigen::VectorXd& residual) {
  std::vector<double> costs;
  Eigen::Index offset = 0;
  for (const ProjectedWindow& window : base.windows()) {
    costs.push_back(0.5 * residual.segment(offset, window.residual.size()).squaredNorm());
    offset += window.residual.size();
  }
  return costs;
}

/// Cost on windows that had no part in the estimate, summed over folds: each fold is predicted by the linear fit to all
/// others. `columns` (may have none) stand beside the base parameters; `offset` is where they are from zero, in sigmas.
double held_out_cost(const Linearisation& base, std::span<const int> folds, const Eigen::VectorXd& residual,
                     const Eigen::MatrixXd& columns, const Eigen::VectorXd& offset) {
  const Eigen::Index n = base.windows()[0].jacobian.cols();
  const Eigen::Index k = columns.cols();
  const auto count = static_cast<std::size_t>(*std::max_element(folds.begin(), folds.end()) + 1);
  std::vector<Eigen::MatrixXd> normal(count, Eigen::MatrixXd::Zero(n + k, n + k));
  std::vector<Eigen::VectorXd> gradient(count, Eigen::VectorXd::Zero(n + k));
  std::vector<double> square(count, 0.0);
  Eigen::Index row = 0;
  for (std::size_t w = 0; w < base.windows().size(); ++w) {
    const Eigen::MatrixXd& J = base.windows()[w].jacobian;
    const auto fold = static_cast<std::size_t>(folds[w]);
    const auto r = residual.segment(row, J.rows());
    const auto E = columns.middleRows(row, J.rows());
    normal[fold].topLeftCorner(n, n) += J.transpose() * J;
    normal[fold].topRightCorner(n, k) += J.transpose() * E;
    normal[fold].bottomRightCorner(k, k) += E.transpose() * E;
    gradient[fold].head(n) += J.transpose() * r;
    gradient[fold].tail(k) += E.transpose() * r;
    square[fold] += r.squaredNorm();
    row += J.rows();
  }
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n + k, n + k);
  Eigen::VectorXd target = Eigen::VectorXd::Zero(n + k);
  for (std::size_t f = 0; f < count; ++f) {
    normal[f].bottomLeftCorner(k, n) = normal[f].topRightCorner(n, k).transpose();
    all += normal[f];
    target += gradient[f];
  }
  // Correlated residuals overstate the data's weight against the prior: where the other folds hardly see the effect,
  // the prior keeps its estimate at zero instead of letting noise set it.
  Eigen::VectorXd prior(n + k);
  prior << base.inflation() * base.prior_information(), Eigen::VectorXd::Constant(k, base.inflation());
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(n + k);
  pull.tail(k) = base.inflation() * offset;
  double cost = 0.0;
  for (std::size_t f = 0; f < count; ++f) {
    Eigen::MatrixXd others = all - normal[f];
    others.diagonal() += prior;
    const Eigen::VectorXd step = -others.ldlt().solve(target - gradient[f] + pull);
    cost += 0.5 * (square[f] + 2.0 * step.dot(gradient[f]) + step.dot(normal[f] * step));
  }
  return cost;
}

/// Fold numbers: `block` windows in a row stay together; or one fold per run.
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

}  // namespace

Linearisation::Linearisation(const identification::TrajectoryFit& problem, const identification::FitResult& fit)
    : problem_{problem}, fit_{fit}, windows_{problem.linearise(fit)} {
  const identification::ParameterMap map{fit.model};
  const auto n = static_cast<Eigen::Index>(map.size());
  prior_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& free = map[static_cast<std::size_t>(i)];
    prior_[i] = (free.scale / free.prior_sigma) * (free.scale / free.prior_sigma);
  }
  Eigen::MatrixXd information = prior_.asDiagonal();
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(n);
  for (const ProjectedWindow& window : windows_) {
    information += window.jacobian.transpose() * window.jacobian;
    spread += (window.jacobian.transpose() * window.residual).cwiseAbs2();
  }
  information_.compute(information);
  inflation_ = std::max(1.0, (spread.array() / information.diagonal().array()).mean());
  block_folds_ = folds_by_block(windows_.size());
  run_folds_ = folds_by_run(problem.windows());
  unexplained_ = stacked_residual();
  remove_base(*this, unexplained_);
  window_cost_ = window_costs(*this, unexplained_.col(0));
}

Eigen::VectorXd Linearisation::stacked_residual() const {
  Eigen::Index rows = 0;
  for (const ProjectedWindow& window : windows_) rows += window.residual.size();
  Eigen::VectorXd all(rows);
  Eigen::Index offset = 0;
  for (const ProjectedWindow& window : windows_) {
    all.segment(offset, window.residual.size()) = window.residual;
    offset += window.residual.size();
  }
  return all;
}

Screened screen(const Linearisation& base, const model::Effect& effect, int variant, const std::string& variant_name,
                const model::Scene& scene) {
  CandidateModel candidate{base, effect, variant, variant_name};
  const auto parameters = effect.parameters();
  const std::size_t k = parameters.size();

  const Eigen::VectorXd unfitted = base.stacked_residual();
  const Eigen::MatrixXd& without = base.unexplained();
  const double cost_without = 0.5 * without.squaredNorm();

  // Rank the starts by what an amplitude along (start - absent) would gain.
  struct Start {
    double gain;
    std::vector<double> theta;
  };
  std::vector<Start> ranked;
  const auto starts = effect.starts(scene, variant);
  for (const auto& start : starts) {
    if (starts.size() == 1) {
      ranked.push_back({0.0, start});
      break;
    }
    Eigen::MatrixXd direction = candidate.residual(start) - unfitted;
    remove_base(base, direction);
    const double bottom = direction.squaredNorm();
    const double top = direction.col(0).dot(without.col(0));
    ranked.push_back({bottom > 0.0 && top < 0.0 ? 0.5 * top * top / bottom : 0.0, start});
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const Start& a, const Start& b) { return a.gain > b.gain; });
  if (ranked.size() > kBestStarts) ranked.resize(kBestStarts);

  Screened best{.effect = &effect, .variant = variant, .variant_name = variant_name, .theta = std::vector<double>(k, 0.0), .window_cost = {}, .signature = {}};
  Eigen::VectorXd best_residual = without.col(0);
  Eigen::MatrixXd best_columns;
  double best_cost = cost_without;
  for (const Start& start : ranked) {
    std::vector<double> theta = clamped(effect, start.theta);
    Eigen::MatrixXd residual = candidate.residual(theta);
    remove_base(base, residual);
    double cost = 0.5 * residual.squaredNorm();
    double damping = 0.0;
    Eigen::MatrixXd columns;
    for (int step = 0; step < kNewtonSteps; ++step) {
      columns.resize(residual.rows(), static_cast<Eigen::Index>(k));
      std::vector<double> sizes(k);
      for (std::size_t i = 0; i < k; ++i) {
        sizes[i] = kSmallStep * std::max(std::abs(theta[i]), 0.1 * parameters[i].sigma);
        if (theta[i] + sizes[i] > parameters[i].high) sizes[i] = -sizes[i];
        std::vector<double> moved = theta;
        moved[i] += sizes[i];
        columns.col(static_cast<Eigen::Index>(i)) = candidate.residual(moved);
      }
      remove_base(base, columns);
      for (std::size_t i = 0; i < k; ++i) {
        const auto c = static_cast<Eigen::Index>(i);
        columns.col(c) = (columns.col(c) - residual.col(0)) * (parameters[i].sigma / sizes[i]);
      }
      // Unknowns in units of their prior sigma, which is also their prior.
      Eigen::MatrixXd normal = columns.transpose() * columns;
      Eigen::VectorXd gradient = columns.transpose() * residual.col(0);
      for (std::size_t i = 0; i < k; ++i) {
        const auto c = static_cast<Eigen::Index>(i);
        normal(c, c) += 1.0 + damping * normal(c, c);
        gradient[c] += theta[i] / parameters[i].sigma;
      }
      const Eigen::VectorXd move = -normal.ldlt().solve(gradient);
      std::vector<double> next = theta;
      for (std::size_t i = 0; i < k; ++i) next[i] += move[static_cast<Eigen::Index>(i)] * parameters[i].sigma;
      next = clamped(effect, next);
      Eigen::MatrixXd next_residual = candidate.residual(next);
      remove_base(base, next_residual);
      const double next_cost = 0.5 * next_residual.squaredNorm();
      if (next_cost >= cost) {
        damping = damping == 0.0 ? 1.0 : 10.0 * damping;
        continue;
      }
      const bool settled = cost - next_cost < 1e-3 * (cost_without - next_cost);
      theta = next;
      residual = next_residual;
      cost = next_cost;
      damping *= 0.1;
      if (settled) break;
    }
    if (cost < best_cost) {
      best_cost = cost;
      best.theta = theta;
      best_residual = residual.col(0);
      best_columns = columns;
    }
  }
  best.gain = cost_without - best_cost;
  best.window_cost = window_costs(base, best_residual);
  best.signature = best_residual - without.col(0);
  if (best.gain > kWorthValidating * cost_without) {
    Eigen::VectorXd offset(static_cast<Eigen::Index>(k));
    for (std::size_t i = 0; i < k; ++i) offset[static_cast<Eigen::Index>(i)] = best.theta[i] / parameters[i].sigma;
    const Eigen::MatrixXd none(without.rows(), 0);
    const auto saved = [&](std::span<const int> folds) {
      const double alone = held_out_cost(base, folds, without.col(0), none, Eigen::VectorXd{});
      return (alone - held_out_cost(base, folds, best_residual, best_columns, offset)) / alone;
    };
    best.held_out_blocks = saved(base.block_folds());
    best.held_out_runs = saved(base.run_folds());
  }
  const double norm = best.signature.norm();
  if (norm > 0.0) best.signature /= norm;
  return best;
}

}  // namespace fathom::diagnosis

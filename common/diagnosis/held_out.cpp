#include "common/diagnosis/held_out.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace fathom::diagnosis {
namespace {

using identification::ProjectedWindow;

constexpr int kFolds = 5;
constexpr std::size_t kFoldBlock = 3;  // windows that stay together, so that held-out data is not a neighbour's echo
constexpr std::size_t kFewestRuns = 3;

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

double cost(const Linearisation& fit, const std::vector<int>& folds, double inflation) {
  const identification::ParameterMap map{fit.fit().model};
  const auto n = static_cast<Eigen::Index>(map.size());
  const auto count = static_cast<std::size_t>(*std::max_element(folds.begin(), folds.end()) + 1);
  std::vector<Eigen::MatrixXd> normal(count, Eigen::MatrixXd::Zero(n, n));
  std::vector<Eigen::VectorXd> gradient(count, Eigen::VectorXd::Zero(n));
  std::vector<double> square(count, 0.0);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd target = Eigen::VectorXd::Zero(n);
  for (std::size_t w = 0; w < folds.size(); ++w) {
    const ProjectedWindow& window = fit.windows()[w];
    const auto fold = static_cast<std::size_t>(folds[w]);
    normal[fold] += window.jacobian.transpose() * window.jacobian;
    gradient[fold] += window.jacobian.transpose() * window.residual;
    square[fold] += window.residual.squaredNorm();
  }
  for (std::size_t f = 0; f < count; ++f) {
    all += normal[f];
    target += gradient[f];
  }
  // Where the other folds hardly see a number, its prior keeps it in place instead of letting noise set it. Correlated
  // residuals overstate the data's weight, so the prior's is raised as much.
  const Eigen::VectorXd x = map.pack(fit.fit().model);
  Eigen::VectorXd prior(n), pull(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& free = map[static_cast<std::size_t>(i)];
    prior[i] = inflation * (free.scale / free.prior_sigma) * (free.scale / free.prior_sigma);
    pull[i] = prior[i] * (x[i] - free.prior_mean / free.scale);
  }
  double total = 0.0;
  for (std::size_t f = 0; f < count; ++f) {
    Eigen::MatrixXd others = all - normal[f];
    others.diagonal() += prior;
    const Eigen::VectorXd step = -others.ldlt().solve(target - gradient[f] + pull);
    total += 0.5 * (square[f] + 2.0 * step.dot(gradient[f]) + step.dot(normal[f] * step));
  }
  return total;
}

}  // namespace

double inflation(const Linearisation& fit) {
  const auto n = fit.windows()[0].jacobian.cols();
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(n), information = Eigen::VectorXd::Zero(n);
  for (const ProjectedWindow& window : fit.windows()) {
    spread += (window.jacobian.transpose() * window.residual).cwiseAbs2();
    information += window.jacobian.colwise().squaredNorm().transpose();
  }
  double sum = 0.0, count = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (information[i] <= 0.0) continue;  // held at a bound
    sum += spread[i] / information[i];
    count += 1.0;
  }
  return count > 0.0 ? std::max(1.0, sum / count) : 1.0;
}

HeldOut held_out(const Linearisation& fit, double inflation) {
  return {cost(fit, folds_by_block(fit.windows().size()), inflation),
          cost(fit, folds_by_run(fit.problem().windows()), inflation)};
}

}  // namespace fathom::diagnosis

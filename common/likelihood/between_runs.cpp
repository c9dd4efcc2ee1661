#include "common/likelihood/between_runs.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/factors.hpp"

namespace fathom::likelihood {
namespace {

constexpr double kLeastKnown = 0.5;  // of the prior's variance that a run must do away with to be heard

/// One run's estimate of a number, less the shared one.
struct Estimate {
  double off{}, variance{};
};

/// Variance between the runs' true values.
double spread_of(const std::vector<Estimate>& runs) {
  double weights = 0.0, squares = 0.0, mean = 0.0;
  for (const Estimate& run : runs) {
    weights += 1.0 / run.variance;
    squares += 1.0 / (run.variance * run.variance);
    mean += run.off / run.variance;
  }
  mean /= weights;
  double Q = 0.0;
  for (const Estimate& run : runs) Q += (run.off - mean) * (run.off - mean) / run.variance;
  return std::max(0.0, (Q - static_cast<double>(runs.size()) + 1.0) / (weights - squares / weights));
}

}  // namespace

BetweenRuns between_runs(const Problem& problem, const Fit& fit, int threads) {
  const auto p = static_cast<Eigen::Index>(fit.numbers.size());
  BetweenRuns between{.spread = Eigen::VectorXd::Zero(p), .sigma = fit.sigma()};
  if (problem.runs.size() < 2) return between;
  const PassResult seen = pass(problem, fit.hypothesis, fit.numbers, fit.noise, {.per_run = true, .threads = threads});
  if (!seen.finite) return between;
  Eigen::VectorXd prior(p);
  for (Eigen::Index j = 0; j < p; ++j) {
    const Number& number = fit.numbers[static_cast<std::size_t>(j)];
    prior[j] = 1.0 / prior_weight(number, value(fit.hypothesis, number));
  }
  std::vector<std::vector<Estimate>> estimates(fit.numbers.size());
  for (const RunInformation& run : seen.per_run) {
    Eigen::MatrixXd information = run.information;
    information.diagonal() += prior.cwiseInverse();
    const SymmetricFactor factor{information};
    const Eigen::VectorXd off = factor.solve(run.gradient);
    const Eigen::MatrixXd covariance = factor.inverse();
    for (Eigen::Index j = 0; j < p; ++j) {
      const double known = 1.0 - covariance(j, j) / prior[j];
      if (fit.numbers[static_cast<std::size_t>(j)].run >= 0 || known < kLeastKnown) continue;
      estimates[static_cast<std::size_t>(j)].push_back({off[j] / known, covariance(j, j) / known});
    }
  }
  for (Eigen::Index j = 0; j < p; ++j) {
    const std::vector<Estimate>& runs = estimates[static_cast<std::size_t>(j)];
    if (runs.size() < 2) continue;
    const double variance = spread_of(runs);
    if (variance == 0.0) continue;
    between.spread[j] = std::sqrt(variance);
    double weight = 0.0;
    for (const Estimate& run : runs) weight += 1.0 / (run.variance + variance);
    between.sigma[j] = std::max(between.sigma[j], std::sqrt(1.0 / weight));
  }
  return between;
}

}  // namespace fathom::likelihood

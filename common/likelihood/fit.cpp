#include "common/likelihood/fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/factors.hpp"
#include "common/likelihood/fitting.hpp"

namespace fathom::likelihood {

Eigen::VectorXd Fit::sigma() const {
  const Eigen::MatrixXd covariance = inverse_symmetric(information);
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

double laplace(const std::vector<Number>& numbers, const Eigen::VectorXd& values, double log_likelihood,
               const Eigen::MatrixXd& information_with_prior) {
  // Scaled by the priors, so that the determinant neither over- nor underflows.
  const auto p = static_cast<Eigen::Index>(numbers.size());
  Eigen::VectorXd sigma(p);
  for (Eigen::Index j = 0; j < p; ++j) sigma[j] = numbers[static_cast<std::size_t>(j)].sigma;
  const Eigen::VectorXd pivots =
      SymmetricFactor{sigma.asDiagonal() * information_with_prior * sigma.asDiagonal()}.pivots();
  double log_det = 0.0;
  for (Eigen::Index j = 0; j < p; ++j) log_det += std::log(std::max(pivots[j], 1e-300));
  log_det -= 2.0 * sigma.array().log().sum();
  return log_likelihood + log_prior(numbers, values) + 0.5 * static_cast<double>(p) * std::log(2.0 * std::numbers::pi) -
         0.5 * log_det;
}

Fit fit(const Problem& problem, Hypothesis start, Noise noise, const FitOptions& options) {
  Fitting fitting{problem, std::move(start), std::move(noise), options};
  fitting.run();
  return fitting.fit();
}

void refer(const Problem& problem, Fit& fit, Reference& reference, int threads) {
  const PassResult seen = pass(problem, fit.hypothesis, fit.numbers, fit.noise, {.threads = threads}, &reference);
  fit.log_likelihood = seen.log_likelihood;
  fit.information = seen.information;
  const Eigen::VectorXd x = values(fit.hypothesis, fit.numbers);
  for (Eigen::Index j = 0; j < x.size(); ++j)
    fit.information(j, j) += prior_weight(fit.numbers[static_cast<std::size_t>(j)], x[j]);
}

}  // namespace fathom::likelihood

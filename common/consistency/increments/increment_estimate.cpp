#include "common/consistency/increments/increment_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/statistics.hpp"
#include "common/consistency/increments/increment_normals.hpp"

namespace fathom::consistency {
namespace {

/// What the misfit of all windows says of a sigma counts as so many blocks: it is right within a factor of two.
constexpr double kMisfitFreedom = 6.0;

/// The jackknife's sigma, of as many degrees of freedom as blocks tell of it, with that of the misfit.
void settle(Estimate& estimate, const Uncertainty& known) {
  const double own = std::max(known.blocks - 1.0, 0.0);
  estimate.freedom = own + kMisfitFreedom;
  estimate.sigma =
      std::sqrt((own * std::pow(estimate.sigma, 2) + kMisfitFreedom * std::pow(known.sigma, 2)) / estimate.freedom);
}

}  // namespace

Uncertainty uncertainty(const IncrementFit& fit, const Eigen::VectorXd& gradient) {
  if (fit.information.empty()) return {};
  Normals all(static_cast<int>(gradient.size()));
  for (const Eigen::MatrixXd& block : fit.information) all.h += block;
  const Eigen::VectorXd influence = all.solve(gradient);
  std::vector<double> shares;
  for (const Eigen::MatrixXd& block : fit.information)
    shares.push_back(std::max(influence.dot(block * influence), 0.0));
  return {std::sqrt(fit.noise * std::max(influence.dot(gradient), 0.0)), effective_count(shares)};
}

Uncertainty delay_uncertainty(const IncrementFit& fit) {
  const double bend = std::accumulate(fit.delay_information.begin(), fit.delay_information.end(), 0.0);
  return {bend > 0.0 ? std::sqrt(2.0 * fit.noise / bend) : 0.0, effective_count(fit.delay_information)};
}

Estimate estimate(const IncrementFit& fit, const std::function<double(const Eigen::VectorXd&)>& read, bool bracket) {
  Estimate result;
  std::vector<double> replicates;
  for (const Eigen::VectorXd& theta : fit.theta_replicates) replicates.push_back(read(theta));
  result.value = read(fit.theta);
  result.sigma = jackknife_sigma(replicates);
  Eigen::VectorXd gradient(fit.theta.size()), moved = fit.theta;
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    constexpr double kStep = 1e-5;
    moved[i] = fit.theta[i] + kStep;
    const double above = read(moved);
    moved[i] = fit.theta[i] - kStep;
    gradient[i] = 0.5 * (above - read(moved)) / kStep;
    moved[i] = fit.theta[i];
  }
  settle(result, uncertainty(fit, gradient));
  if (fit.unseen_delay > 0.0) result.sigma = std::hypot(result.sigma, gradient.dot(fit.per_delay) * fit.unseen_delay);
  if (bracket) {
    // The sensor's own noise pulls the plain value toward zero, taking it out may overshoot: the truth is between.
    const double half = 0.5 * (read(fit.theta_upper) - result.value);
    result.value += half;
    result.sigma = std::hypot(result.sigma, half);
  }
  result.informative = true;
  return result;
}

Estimate estimate_delay(const IncrementFit& fit) {
  Estimate result{.value = fit.delay, .sigma = jackknife_sigma(fit.delay_replicates), .informative = true};
  settle(result, delay_uncertainty(fit));
  return result;
}

}  // namespace fathom::consistency

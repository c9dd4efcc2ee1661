#include "common/identification/regression/autoregression.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace fathom::identification {
namespace {

constexpr double kLargest = 0.99999;  // of phi: a residual that never forgets leaves nothing to fit
constexpr double kConverged = 1e-10;
constexpr int kMostIterations = 50;

}  // namespace

AutoregressiveFit fit_autoregressive(const LaggedGram& gram, const std::vector<int>& columns, const double* fixed_phi) {
  const auto p = static_cast<Eigen::Index>(columns.size());
  const Eigen::Index b = gram.columns() - 1;
  std::vector<Eigen::Index> chosen(columns.begin(), columns.end());
  chosen.push_back(b);
  AutoregressiveFit fit;
  fit.phi = fixed_phi != nullptr ? *fixed_phi : 0.0;
  Eigen::VectorXd c = Eigen::VectorXd::Zero(gram.columns());
  const double freedom = std::max(1.0, static_cast<double>(gram.samples()) - static_cast<double>(p) - 1.0);
  LaggedGram::Residual e;
  const auto solve = [&] {
    const Eigen::MatrixXd G = gram.whitened(fit.phi)(chosen, chosen);
    fit.sse = G(p, p);
    if (p > 0) {
      // Scaled to a unit diagonal, so that the factor sees correlations and not units.
      const Eigen::VectorXd scale = G.topLeftCorner(p, p).diagonal().cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd R = scale.asDiagonal() * G.topLeftCorner(p, p) * scale.asDiagonal();
      const Eigen::LLT<Eigen::MatrixXd> factor{R};
      fit.x = scale.cwiseProduct(factor.solve(scale.cwiseProduct(G.col(p).head(p))));
      fit.covariance = scale.asDiagonal() * factor.solve(Eigen::MatrixXd::Identity(p, p)) * scale.asDiagonal();
      fit.sse = std::max(0.0, G(p, p) - fit.x.dot(G.col(p).head(p)));
    } else {
      fit.x.resize(0);
      fit.covariance.resize(0, 0);
    }
    c.setZero();
    c[b] = 1.0;
    for (Eigen::Index i = 0; i < p; ++i) c[chosen[static_cast<std::size_t>(i)]] = -fit.x[i];
    e = gram.residual(c);
  };
  solve();
  if (fixed_phi == nullptr) {
    // Gauss-Newton in phi with the coefficients at their best for it (variable projection): the derivative of
    // sum e^2 is that at fixed coefficients.
    for (fit.iterations = 1; fit.iterations <= kMostIterations; ++fit.iterations) {
      const double slope = fit.phi * (e.lagged - e.first) - e.cross;
      const double curvature = e.lagged - e.first;
      if (!(curvature > 0.0)) break;
      const double next = std::clamp(fit.phi - slope / curvature, -kLargest, kLargest);
      const double change = next - fit.phi;
      fit.phi = next;
      solve();
      if (std::abs(change) < kConverged) break;
    }
  }
  fit.variance = fit.sse / freedom;
  fit.covariance *= fit.variance;
  fit.phi_sigma = e.lagged > 0.0 ? std::sqrt(fit.variance / e.lagged) : 0.0;
  return fit;
}

}  // namespace fathom::identification

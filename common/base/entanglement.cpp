#include "common/base/entanglement.hpp"

#include <Eigen/Core>
#include <cmath>

#include "common/base/factors.hpp"

namespace fathom {

Entanglement entanglement(std::span<const double> covariance) {
  const auto n = static_cast<Eigen::Index>(std::lround(std::sqrt(static_cast<double>(covariance.size()))));
  if (n == 0 || n * n != static_cast<Eigen::Index>(covariance.size())) return {};
  const Eigen::Map<const Eigen::MatrixXd> P{covariance.data(), n, n};
  if (!P.allFinite() || !(P.diagonal().minCoeff() > 0.0)) return {};
  const Eigen::VectorXd scale = P.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * P * scale.asDiagonal();
  const SymmetricEigen eigen = symmetric_eigen(correlation);
  const Eigen::VectorXd& values = eigen.values;  // ascending
  if (!eigen.found || !(values[0] > 1e-14 * values[n - 1])) return {};
  Entanglement found{.inflation = std::vector<double>(static_cast<std::size_t>(n)),
                     .condition = values[n - 1] / values[0]};
  // Diagonal of the inverse correlations: P_ii (P^-1)_ii.
  Eigen::Map<Eigen::VectorXd>{found.inflation.data(), n} = eigen.vectors.cwiseAbs2() * values.cwiseInverse();
  return found;
}

}  // namespace fathom

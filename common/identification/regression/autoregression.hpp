// Least squares under a first-order autoregressive residual z_n = e_n + phi z_n-1 (Pereira and Duncan, eq. 16 with its
// noise term): Gauss-Newton on the coefficients and phi, the first sample of every stretch kept (Prais and Winsten
// 1954).
#pragma once

#include <vector>

#include "common/identification/regression/lagged_gram.hpp"

namespace fathom::identification {

struct AutoregressiveFit {
  Eigen::VectorXd x;           ///< coefficients of the chosen columns
  Eigen::MatrixXd covariance;  ///< of x, from white e
  double phi{};
  double phi_sigma{};
  double sse{};       ///< sum of e^2
  double variance{};  ///< of e
  int iterations{};
};

/// Fit on `columns` of A. With `fixed_phi` phi stays; 0 is plain least squares. The columns must not be collinear.
[[nodiscard]] AutoregressiveFit fit_autoregressive(const LaggedGram& gram, const std::vector<int>& columns,
                                                   const double* fixed_phi = nullptr);

}  // namespace fathom::identification

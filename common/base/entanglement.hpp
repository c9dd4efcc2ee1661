// How far parameters that are learnt together can be told apart, in numbers without units: what the rank of a regressor
// of mixed units cannot say.
#pragma once

#include <span>
#include <vector>

namespace fathom {

struct Entanglement {
  /// Of each parameter: its variance over what it would be, were all others known (variance inflation factor). 1: the
  /// others do not matter; 100: nine tenths of its standard deviation are theirs.
  std::vector<double> inflation;
  /// Largest over smallest eigenvalue of the correlations: 1 when all are independent, without bound where only a
  /// combination of some is known (the regressor lacks a rank).
  double condition{};
};

/// Of a covariance, row by row; rescaling a parameter changes nothing. Without entries, and with a condition of zero,
/// when it is not a covariance: another size than n by n, not finite, or not positive definite to rounding.
[[nodiscard]] Entanglement entanglement(std::span<const double> covariance);

}  // namespace fathom

// What a linear system does over a step: E = exp(A dt) and Gamma = integral of exp(A s) ds from 0 to dt, by scaling and
// squaring (Higham 2005): a Taylor series of third order for the whole step breaks where damping times step
// exceeds 2.5.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace fathom::likelihood {

template <int N>
struct Transition {
  using Matrix = Eigen::Matrix<double, N, N>;
  Matrix E, Gamma;

  Transition(const Matrix& A, double dt) {
    const double size = A.cwiseAbs().rowwise().sum().maxCoeff() * dt;
    int doublings = 0;
    for (double part = size; part > kLargest && doublings < kMostDoublings; part *= 0.5) ++doublings;
    const double h = std::ldexp(dt, -doublings);
    // Gamma = h (I + X/2 + X^2/6 + X^3/24 + X^4/120), E = I + A Gamma.
    const Matrix X = A * h, X2 = X * X, identity = Matrix::Identity();
    Gamma = h * (identity + X / 2.0 + X2 / 6.0 + X2 * (X / 24.0 + X2 / 120.0));
    E = identity + A * Gamma;
    for (int i = 0; i < doublings; ++i) {
      Gamma = (Gamma + E * Gamma).eval();
      E = (E * E).eval();
    }
  }

 private:
  static constexpr double kLargest = 0.125;  // the first term that is left out is then under 1e-8
  static constexpr int kMostDoublings = 20;
};

}  // namespace fathom::likelihood

#include "common/estimation/smoothing_derivative.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace fathom::estimation {
namespace {

SmoothingDerivative quartic(int half, double step, double bandwidth) {
  const int count = 2 * half + 1;
  Eigen::MatrixXd powers(count, 5);
  for (int i = 0; i < count; ++i) {
    const double x = static_cast<double>(i - half) / half;
    for (int k = 0; k < 5; ++k) powers(i, k) = std::pow(x, k);
  }
  const Eigen::MatrixXd inverse = powers.completeOrthogonalDecomposition().pseudoInverse();
  SmoothingDerivative result{.half = half, .weight = {}, .gain = 0.0, .noise = 0.0};
  double squares = 0.0, gain = 0.0;
  const double omega = 2.0 * std::numbers::pi * bandwidth;
  for (int i = 0; i < count; ++i) {
    const double weight = inverse(1, i) / (half * step);
    result.weight.push_back(weight);
    squares += weight * weight;
    gain += weight * std::sin(omega * (i - half) * step) / omega;
  }
  result.gain = gain;
  result.noise = std::sqrt(squares);
  return result;
}

}  // namespace

SmoothingDerivative smoothing_derivative(double step, double bandwidth, double tolerance) {
  SmoothingDerivative best = quartic(2, step, bandwidth);
  for (int half = 3; half < 200; ++half) {
    SmoothingDerivative longer = quartic(half, step, bandwidth);
    if (std::abs(longer.gain - 1.0) > tolerance) break;
    best = std::move(longer);
  }
  return best;
}

}  // namespace fathom::estimation

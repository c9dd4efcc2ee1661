#include "common/estimation/smoothing_derivative.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/factors.hpp"
#include "common/base/least_squares.hpp"

namespace fathom::estimation {
namespace {

SmoothingDerivative quartic(int half, double step, double bandwidth) {
  const int count = 2 * half + 1;
  Eigen::MatrixXd powers(count, 5);
  for (int i = 0; i < count; ++i) {
    const double x = static_cast<double>(i - half) / half;
    for (int k = 0; k < 5; ++k) powers(i, k) = std::pow(x, k);
  }
  const Eigen::MatrixXd inverse = pseudo_inverse(powers);
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

std::vector<double> slope_weights(std::span<const double> t) {
  const double scale = std::max(-t.front(), t.back());
  Eigen::Matrix<double, 5, Eigen::Dynamic> powers(5, static_cast<Eigen::Index>(t.size()));
  powers.row(0).setOnes();
  for (Eigen::Index i = 0; i < powers.cols(); ++i) {
    for (Eigen::Index k = 1; k < 5; ++k) powers(k, i) = powers(k - 1, i) * t[static_cast<std::size_t>(i)] / scale;
  }
  const Eigen::Matrix<double, 5, 5> normal = powers * powers.transpose();
  const Eigen::Matrix<double, 5, 1> slope = solve_symmetric(normal, Eigen::VectorXd::Unit(5, 1)) / scale;
  std::vector<double> weight(t.size());
  Eigen::Map<Eigen::RowVectorXd>(weight.data(), powers.cols()) = slope.transpose() * powers;
  return weight;
}

}  // namespace fathom::estimation

#include "common/identification/trajectories/pressed_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/least_squares.hpp"
#include "common/identification/trajectories/box_step.hpp"
#include "common/identification/trajectories/outlier.hpp"

namespace fathom::identification {
namespace {

constexpr double kNearly = 0.05;  // of a number's scale

struct NormalEquations {
  Eigen::MatrixXd A;
  Eigen::VectorXd g;
};

NormalEquations of_window(const Evaluations::One& at, const WindowResidual& window) {
  const Eigen::VectorXd weight = robust_weight(at.residual, window.axes());
  const Eigen::MatrixXd initial = weight.asDiagonal() * at.by_initial;
  Eigen::MatrixXd jacobian = weight.asDiagonal() * at.by_parameter;
  Eigen::VectorXd residual = at.residual.cwiseProduct(weight);
  const Eigen::MatrixXd basis = range_basis(initial);
  jacobian -= basis * (basis.transpose() * jacobian).eval();
  residual -= basis * (basis.transpose() * residual).eval();
  return {jacobian.transpose() * jacobian, jacobian.transpose() * residual};
}

}  // namespace

BoundedStep bounded_step(const Evaluations& evaluations, std::span<const WindowResidual> windows,
                         const ParameterMap& map, const Eigen::VectorXd& x, int threads) {
  std::vector<NormalEquations> parts(windows.size());
  for_each_index(windows.size(), threads, [&](std::size_t w) { parts[w] = of_window(evaluations.at(w), windows[w]); });
  const Eigen::Index n = x.size();
  NormalEquations all{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (const NormalEquations& part : parts) {
    all.A += part.A;
    all.g += part.g;
  }
  Eigen::VectorXd low(n), high(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& free = map[static_cast<std::size_t>(i)];
    const double per_sigma = free.scale / free.prior_sigma;
    all.A(i, i) += per_sigma * per_sigma;
    if (free.sought) all.g[i] += (x[i] * free.scale - free.prior_mean) / free.prior_sigma * per_sigma;
    low[i] = std::min(free.low / free.scale - x[i], 0.0);
    high[i] = std::max(free.high / free.scale - x[i], 0.0);
  }
  BoundedStep step{.d = box_step(all.A, all.g, low, high), .deviation = all.A.diagonal().cwiseSqrt().cwiseInverse()};
  step.foretold = -step.d.dot(all.g + 0.5 * (all.A * step.d));
  return step;
}

std::vector<int> pressed_numbers(const ParameterMap& map, const Eigen::VectorXd& x, const BoundedStep& step) {
  std::vector<int> pressed;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const bool nearly = std::abs(step.d[k]) < std::max(kNearly, step.deviation[k]);
    if (nearly && map[i].at_bound(x[k] + step.d[k])) pressed.push_back(static_cast<int>(i));
  }
  return pressed;
}

InsideBounds::InsideBounds(const ParameterMap& map, const std::vector<int>& held) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    low_.push_back(map[i].low / map[i].scale);
    high_.push_back(map[i].high / map[i].scale);
    if (std::ranges::find(held, static_cast<int>(i)) == held.end()) free_.push_back(i);
  }
}

bool InsideBounds::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  std::copy_n(x, low_.size(), x_plus_delta);
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const std::size_t i = free_[k];
    const double distance = std::max(delta[k] < 0.0 ? x[i] - low_[i] : high_[i] - x[i], 0.0);
    const double way = std::isinf(distance) ? std::abs(delta[k])
                       : distance > 0.0     ? -distance * std::expm1(-std::abs(delta[k]) / distance)
                                            : 0.0;
    x_plus_delta[i] =
        std::clamp(x[i] + std::copysign(way, delta[k]), std::min(low_[i], x[i]), std::max(high_[i], x[i]));
  }
  return true;
}

bool InsideBounds::PlusJacobian(const double* /*x*/, double* jacobian) const {
  std::fill_n(jacobian, low_.size() * free_.size(), 0.0);
  for (std::size_t k = 0; k < free_.size(); ++k) jacobian[free_[k] * free_.size() + k] = 1.0;
  return true;
}

bool InsideBounds::Minus(const double* y, const double* x, double* y_minus_x) const {
  for (std::size_t k = 0; k < free_.size(); ++k) y_minus_x[k] = y[free_[k]] - x[free_[k]];
  return true;
}

bool InsideBounds::MinusJacobian(const double* /*x*/, double* jacobian) const {
  std::fill_n(jacobian, low_.size() * free_.size(), 0.0);
  for (std::size_t k = 0; k < free_.size(); ++k) jacobian[k * low_.size() + free_[k]] = 1.0;
  return true;
}

}  // namespace fathom::identification

#include "common/preflight/thrust_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/factors.hpp"
#include "common/residual/force_residual.hpp"

namespace fathom::preflight {
namespace {

constexpr Eigen::Index kBaseTerms = 8;
constexpr double kRidge = 1e-9;       // of a column's size: columns of one table may depend on each other
constexpr double kLeastLeft = 1e-12;  // of the acceleration's square: data without noise

/// Constant, drag, Coriolis forces of mass and added mass (Fossen 2011, eq. 6.44), weight and righting moment.
Eigen::Matrix<double, kBaseTerms, 1> base_terms(const Trial& trial, std::size_t k, std::size_t axis) {
  constexpr std::array<std::array<int, 4>, 6> kProducts{
      {{1, 5, 2, 4}, {0, 5, 2, 3}, {0, 4, 1, 3}, {1, 2, 4, 5}, {0, 2, 3, 5}, {0, 1, 3, 4}}};
  const Vector6d& nu = trial.nu[k];
  const auto& of = kProducts[axis];
  const double v = nu[static_cast<Eigen::Index>(axis)];
  const Eigen::Vector3d down = trial.q_WB[k].conjugate() * Eigen::Vector3d::UnitZ();
  Eigen::Matrix<double, kBaseTerms, 1> terms;
  terms << 1.0, v, v * std::abs(v), nu[of[0]] * nu[of[1]], nu[of[2]] * nu[of[3]], down;
  return terms;
}

bool valid(const Trial& trial, std::size_t k) {
  return (!trial.observed.velocity || trial.velocity_valid[k] != 0) &&
         (!trial.observed.rates || trial.rates_valid[k] != 0) && trial.input[k].allFinite();
}

/// The base terms, the inputs and last the acceleration of one axis, over the span around sample `middle`.
Eigen::VectorXd row_at(const Trial& trial, std::size_t middle, std::size_t axis, std::span<const double> weight) {
  const Eigen::Index inputs = trial.input[middle].size();
  Eigen::VectorXd row = Eigen::VectorXd::Zero(kBaseTerms + inputs + 1);
  double squares = 0.0, slope = 0.0;
  const std::size_t half = weight.size() - 1;
  for (std::size_t k = middle - half; k <= middle + half; ++k) {
    const std::size_t apart = k > middle ? k - middle : middle - k;
    const double offset = (static_cast<double>(k) - static_cast<double>(middle)) * trial.dt;
    row.head<kBaseTerms>() += weight[apart] * base_terms(trial, k, axis);
    row.segment(kBaseTerms, inputs) += weight[apart] * trial.input[k];
    slope += offset * trial.nu[k][static_cast<Eigen::Index>(axis)];
    squares += offset * offset;
  }
  row[row.size() - 1] = slope / squares;
  return row;
}

}  // namespace

ThrustEvidence::ThrustEvidence(const model::Vehicle& vehicle, std::span<const Trial> trials) {
  const Eigen::Index inputs = trials.front().input.front().size();
  const Eigen::Index rest = inputs + 1;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    if (!vehicle.dof[a]) continue;
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(kBaseTerms + rest, kBaseTerms + rest);
    Axis& axis = axes_[a];
    for (const Trial& trial : trials) {
      if (!(a < 3 ? trial.observed.velocity : trial.observed.rates)) continue;
      const std::size_t span = residual::residual_span(trial.dt), half = span / 2;
      const std::vector<double> weight = residual::acceleration_weights(half);
      for (std::size_t k = half; k + half < trial.size(); k += span) {
        bool whole = true;
        for (std::size_t i = k - half; i <= k + half; ++i) whole = whole && valid(trial, i);
        if (!whole) continue;
        const Eigen::VectorXd row = row_at(trial, k, a, weight);
        gram += row * row.transpose();
        axis.rows += 1.0;
      }
    }
    gram.diagonal() *= 1.0 + kRidge;
    for (Eigen::Index i = 0; i < gram.rows(); ++i) gram(i, i) = std::max(gram(i, i), kLeastLeft);
    const Eigen::MatrixXd base = gram.topLeftCorner(kBaseTerms, kBaseTerms),
                          side = gram.topRightCorner(kBaseTerms, rest);
    const Eigen::MatrixXd left =
        gram.bottomRightCorner(rest, rest) - side.transpose() * SymmetricFactor{base}.solve_columns(side);
    axis.inputs = left.topLeftCorner(inputs, inputs);
    axis.both = left.topRightCorner(inputs, 1);
    axis.square = left(inputs, inputs);
  }
}

double ThrustEvidence::cost(const Eigen::Matrix<double, 6, Eigen::Dynamic>& allocation) const {
  double sum = 0.0;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const Axis& axis = axes_[a];
    if (axis.rows == 0.0 || axis.square <= 0.0) continue;
    const Eigen::VectorXd of = allocation.row(static_cast<Eigen::Index>(a)).transpose();
    const double product = of.dot(axis.both), square = of.dot(axis.inputs * of);
    const double explained = product > 0.0 && square > 0.0 ? product * product / square : 0.0;
    sum += 0.5 * axis.rows * std::log(std::max(1.0 - explained / axis.square, kLeastLeft));
  }
  return sum;
}

}  // namespace fathom::preflight

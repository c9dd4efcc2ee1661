#include "common/diagnosis/random_force.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/diagnosis/moved.hpp"
#include "common/identification/parameter_map.hpp"
#include "common/residual/force_residual.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FreeParameter;
using identification::ParameterMap;

constexpr int kRounds = 6;               // of numbers and memories, each for the other
constexpr double kSmallestSize = 1e-12;  // m/s^2, rad/s^2: an axis without residual
constexpr double kSmallestMass = 1e-9;   // kg, kg m^2
constexpr double kStep = 1e-4;           // of a number's scale

double information(const FreeParameter& number) { return std::pow(number.scale / number.prior_sigma, 2); }

/// The model with that number moved a little.
model::Model moved(const model::Model& model, const ParameterMap& map, std::size_t number) {
  Eigen::VectorXd x = map.pack(model);
  x[static_cast<Eigen::Index>(number)] += kStep;
  model::Model other = model;
  map.unpack(x, other);
  return other;
}

bool holds(const model::Model& model, const model::ActiveEffect& effect) {
  return std::ranges::any_of(model.effects, [&](const model::ActiveEffect& one) {
    return one.effect == effect.effect && one.variant == effect.variant;
  });
}

}  // namespace

RandomForce::Series RandomForce::residuals(const model::Model& model) const {
  const Vector6d mass = model.theta.head<6>().cwiseMax(kSmallestMass);
  Series all;
  for (const Trial& trial : trials_) {
    const std::vector<Vector6d> dense = wrench_residuals(model, trial);
    const std::size_t span = residual_span(trial.dt);
    const std::size_t count = dense.size() > span / 2 ? (dense.size() - span / 2 + span - 1) / span : 0;
    Eigen::MatrixXd& few = all.emplace_back(static_cast<Eigen::Index>(count), 6);
    for (std::size_t i = 0; i < count; ++i)
      few.row(static_cast<Eigen::Index>(i)) = dense[span / 2 + i * span].cwiseQuotient(mass).transpose();
  }
  return all;
}

std::vector<RandomForce::Stretch> RandomForce::stretches(const Series& left, std::span<const Series> changes) const {
  std::vector<Stretch> all;
  for (std::size_t r = 0; r < left.size(); ++r) {
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      const Eigen::Index n = left[r].rows();
      for (Eigen::Index from = 0, to = 0; from < n; from = to + 1) {
        for (to = from; to < n && std::isfinite(left[r](to, axis));) ++to;
        if (to - from <= 2 * kOrder) continue;
        Stretch& stretch =
            all.emplace_back(Stretch{axis, Eigen::MatrixXd(to - from, static_cast<Eigen::Index>(changes.size()) + 1)});
        stretch.rows.col(0) = left[r].col(axis).segment(from, to - from);
        for (std::size_t j = 0; j < changes.size(); ++j)
          stretch.rows.col(static_cast<Eigen::Index>(j) + 1) = changes[j][r].col(axis).segment(from, to - from);
      }
    }
  }
  return all;
}

Eigen::MatrixXd RandomForce::unforetold(const Stretch& stretch, const Noise& noise) {
  const Memory& memory = noise.memory[static_cast<std::size_t>(stretch.axis)];
  const Eigen::Index n = stretch.rows.rows() - kOrder;
  Eigen::MatrixXd out = stretch.rows.bottomRows(n);
  for (Eigen::Index lag = 1; lag <= kOrder; ++lag) out -= memory[lag - 1] * stretch.rows.middleRows(kOrder - lag, n);
  return out;
}

RandomForce::Fit RandomForce::fit(std::span<const Stretch> stretches, const Eigen::VectorXd& prior, bool remembers) {
  Fit fit;
  fit.noise.memory.fill(Memory::Zero());
  const Eigen::Index p = prior.size();
  Eigen::VectorXd numbers = Eigen::VectorXd::Unit(p + 1, 0);
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd normal = prior.asDiagonal();
    Eigen::VectorXd right = Eigen::VectorXd::Zero(p);
    for (const Stretch& stretch : stretches) {
      const Eigen::MatrixXd rows = unforetold(stretch, fit.noise);
      normal += fit.noise.weight[stretch.axis] * rows.rightCols(p).transpose() * rows.rightCols(p);
      right -= fit.noise.weight[stretch.axis] * rows.rightCols(p).transpose() * rows.col(0);
    }
    numbers.tail(p) = normal.ldlt().solve(right);
    if (remembers) {
      std::array<Eigen::Matrix<double, kOrder, kOrder>, 6> of_past;
      std::array<Memory, 6> with_past;
      of_past.fill(Eigen::Matrix<double, kOrder, kOrder>::Zero());
      with_past.fill(Memory::Zero());
      for (const Stretch& stretch : stretches) {
        const Eigen::VectorXd left = stretch.rows * numbers;
        const auto axis = static_cast<std::size_t>(stretch.axis);
        for (Eigen::Index k = kOrder; k < left.size(); ++k) {
          const Memory past = left.segment<kOrder>(k - kOrder).reverse();
          of_past[axis] += past * past.transpose();
          with_past[axis] += left[k] * past;
        }
      }
      for (std::size_t axis = 0; axis < 6; ++axis) {
        if (of_past[axis].trace() > 0.0) fit.noise.memory[axis] = of_past[axis].ldlt().solve(with_past[axis]);
      }
    }
    Vector6d square = Vector6d::Zero(), count = Vector6d::Zero();
    for (const Stretch& stretch : stretches) {
      const Eigen::VectorXd left = unforetold(stretch, fit.noise) * numbers;
      square[stretch.axis] += left.squaredNorm();
      count[stretch.axis] += static_cast<double>(left.size());
    }
    fit.log_likelihood = 0.0;
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      if (!(square[axis] > kSmallestSize * kSmallestSize)) continue;
      fit.noise.weight[axis] = count[axis] / square[axis];
      fit.log_likelihood += 0.5 * count[axis] * std::log(fit.noise.weight[axis]);
      if (remembers) fit.log_likelihood -= 0.5 * static_cast<double>(kOrder) * std::log(count[axis]);
    }
  }
  return fit;
}

RandomForce::RandomForce(const model::Model& reference, std::span<const Trial> trials)
    : reference_{reference}, trials_{trials} {
  left_ = residuals(reference);
  const ParameterMap map{reference};
  std::vector<double> prior;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!map[i].sought) continue;
    Series& change = changes_.emplace_back(residuals(moved(reference, map, i)));
    for (std::size_t r = 0; r < change.size(); ++r) change[r] = (change[r] - left_[r]) / kStep;
    prior.push_back(information(map[i]));
  }
  prior_ = Eigen::Map<const Eigen::VectorXd>(prior.data(), static_cast<Eigen::Index>(prior.size()));
  const std::vector<Stretch> all = stretches(left_, changes_);
  plain_ = fit(all, prior_, false);
  remembering_ = fit(all, prior_, true);
}

double RandomForce::expected(const Series& left) const {
  Series act = left_;
  for (std::size_t r = 0; r < act.size(); ++r) act[r] -= left[r];
  const Eigen::Index p = prior_.size();
  Eigen::MatrixXd normal = prior_.asDiagonal();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(p);
  double square = 0.0;
  for (const Stretch& stretch : stretches(act, changes_)) {
    const Eigen::MatrixXd rows = unforetold(stretch, remembering_.noise);
    const double weight = remembering_.noise.weight[stretch.axis];
    normal += weight * rows.rightCols(p).transpose() * rows.rightCols(p);
    right += weight * rows.rightCols(p).transpose() * rows.col(0);
    square += weight * rows.col(0).squaredNorm();
  }
  return 0.5 * std::max(square - right.dot(normal.ldlt().solve(right)), 0.0);
}

RandomForce::Answer RandomForce::ask(const model::Model& model) const {
  const Series left = residuals(model);
  std::vector<Series> changes = changes_;
  const ParameterMap map{model};
  std::vector<double> prior(prior_.begin(), prior_.end());
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!map[i].sought || map[i].effect < 0) continue;
    if (holds(reference_, model.effects[static_cast<std::size_t>(map[i].effect)])) continue;
    Series& change = changes.emplace_back(residuals(moved(model, map, i)));
    for (std::size_t r = 0; r < change.size(); ++r) change[r] = (change[r] - left[r]) / kStep;
    prior.push_back(information(map[i]));
  }
  const std::vector<Stretch> all = stretches(left, changes);
  const Eigen::VectorXd priors =
      Eigen::Map<const Eigen::VectorXd>(prior.data(), static_cast<Eigen::Index>(prior.size()));
  const double reference = plain_.log_likelihood;
  return {.effect = fit(all, priors, false).log_likelihood - reference,
          .memory = remembering_.log_likelihood - reference,
          .both = fit(all, priors, true).log_likelihood - reference,
          .expected = expected(left)};
}

}  // namespace fathom::diagnosis

#include "common/residual/force_residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/rollout.hpp"

namespace fathom::residual {
namespace {

constexpr double kSpan = 0.5;  // s, of the straight line whose slope is the acceleration

struct Sides {
  Vector6d still;                    ///< residual of the sample if it did not accelerate: minus the load
  Eigen::Matrix<double, 6, 6> mass;  ///< what acceleration adds to it
};

std::vector<Sides> sides_of(const model::Model& model, const Trial& trial, const model::VelocityTrace& nu) {
  std::vector<Sides> sides;
  sides.reserve(trial.size());
  const model::InputSignal input = model::input_of(model, trial);
  std::vector<double> memory(static_cast<std::size_t>(model.memory_size()), 0.0);
  for (std::size_t k = 0; k < trial.size(); ++k) {
    model::Motion motion{.t = trial.t[k],
                         .p_WB = trial.p_WB[k],
                         .R_WB = trial.q_WB[k].toRotationMatrix(),
                         .nu = nu.col(static_cast<Eigen::Index>(k))};
    input.at(motion.t, motion.force);
    motion.voltage = trial.voltage.empty() ? 0.0 : trial.voltage[k];
    if (!trial.columns.empty())
      motion.columns = {trial.columns[k].data(), static_cast<std::size_t>(trial.columns[k].size())};
    motion.input = &input;
    motion.vehicle = model.vehicle;
    if (k == 0) model::settle(model, motion, memory);
    model::feel(model, motion, memory, k == 0 ? 0.0 : trial.dt);
    Sides& of = sides.emplace_back();
    of.still = model::residual_wrench(model, motion, Vector6d::Zero());
    for (int i = 0; i < 6; ++i) of.mass.col(i) = model::residual_wrench(model, motion, Vector6d::Unit(i)) - of.still;
  }
  return sides;
}

}  // namespace

std::size_t residual_span(double dt) {
  return 2 * std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(0.5 * kSpan / dt))) + 1;
}

double slope_noise(double dt) {
  double squares = 0.0;  // s^2, of the offsets
  for (std::size_t i = 1; i <= residual_span(dt) / 2; ++i) squares += 2.0 * std::pow(static_cast<double>(i) * dt, 2);
  return 1.0 / std::sqrt(squares);
}

std::vector<double> acceleration_weights(std::size_t half) {
  double squares = 0.0;
  for (std::size_t i = 1; i <= half; ++i) squares += 2.0 * static_cast<double>(i * i);
  std::vector<double> weight(half + 1, 0.0);
  for (std::size_t step = 0; step < half; ++step) {  // between sample `step` and the next
    double share = 0.0;
    for (std::size_t i = step + 1; i <= half; ++i) share += static_cast<double>(i) / squares;
    weight[step] += (step == 0 ? 1.0 : 0.5) * share;  // the middle has such a step on either side
    weight[step + 1] += 0.5 * share;
  }
  return weight;
}

std::vector<Vector6d> wrench_residuals(const model::Model& model, const Trial& trial) {
  const std::size_t half = residual_span(trial.dt) / 2;
  const double squares = std::pow(slope_noise(trial.dt), -2.0);  // s^2, of the offsets
  const std::vector<double> weight = acceleration_weights(half);
  std::vector<Vector6d> residuals(trial.size(), Vector6d::Constant(std::numeric_limits<double>::quiet_NaN()));
  const model::VelocityTrace nu = model::true_velocities(model, trial, 0, trial.size());
  const std::vector<Sides> sides = sides_of(model, trial, nu);
  Eigen::Array<bool, 6, 1> asked;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    asked[static_cast<Eigen::Index>(axis)] =
        model.vehicle->dof[axis] && (axis < 3 ? trial.observed.velocity : trial.observed.rates);
  }
  for (std::size_t k = half; k + half < trial.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    bool valid = true;
    Vector6d slope = Vector6d::Zero(), still = weight[0] * sides[k].still;
    for (std::size_t i = 1; i <= half; ++i) {
      const auto apart = static_cast<Eigen::Index>(i);
      slope += static_cast<double>(i) * trial.dt * (nu.col(at + apart) - nu.col(at - apart));
      still += weight[i] * (sides[k - i].still + sides[k + i].still);
      for (const std::size_t j : {k - i, k + i}) {
        valid = valid && (!trial.observed.velocity || trial.velocity_valid[j] != 0) &&
                (!trial.observed.rates || trial.rates_valid[j] != 0);
      }
    }
    if (valid) residuals[k] = asked.select(sides[k].mass * (slope / squares) + still, residuals[k]);
  }
  return residuals;
}

std::vector<std::vector<Vector6d>> wrench_residuals(const model::Model& model, std::span<const Trial> trials) {
  std::vector<std::vector<Vector6d>> residuals;
  for (const Trial& trial : trials) residuals.push_back(wrench_residuals(model, trial));
  return residuals;
}

std::map<std::string, double> force_rmse(const model::Vehicle& vehicle,
                                         std::span<const std::vector<Vector6d>> residuals) {
  std::map<std::string, double> rmse;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!vehicle.dof[axis]) continue;
    double square = 0.0, count = 0.0;
    for (const auto& run : residuals) {
      for (const Vector6d& wrench : run) {
        const double value = wrench[static_cast<Eigen::Index>(axis)];
        if (!std::isfinite(value)) continue;
        square += value * value;
        count += 1.0;
      }
    }
    if (count > 0.0) rmse[model::kAxisNames[axis]] = std::sqrt(square / count);
  }
  return rmse;
}

}  // namespace fathom::residual

#include "common/identification/window_residual.hpp"

#include <algorithm>

namespace fathom::identification {
namespace {

// Relative to the parameter's scale: truncation and rounding of the rollout (1e-12) are both below 1e-4 of a column.
constexpr double kParameterStep = 1e-4;
constexpr double kInitialStep = 1e-4;  // m/s, rad/s
constexpr double kSmallestShareValid = 0.5;

bool all_valid(const Trial& trial, std::size_t k) {
  return (!trial.observed.position && !trial.observed.attitude ? true : trial.pose_valid[k] != 0) &&
         (!trial.observed.velocity || trial.velocity_valid[k] != 0) &&
         (!trial.observed.rates || trial.rates_valid[k] != 0);
}

}  // namespace

std::vector<model::Window> cut_windows(std::span<const Trial> trials, double length) {
  std::vector<model::Window> windows;
  for (const Trial& trial : trials) {
    const auto count = static_cast<std::size_t>(length / trial.dt + 0.5) + 1;
    std::size_t start = 0;
    while (start + count <= trial.size()) {
      if (!all_valid(trial, start)) {
        ++start;
        continue;
      }
      std::size_t valid = 0;
      for (std::size_t k = start; k < start + count; ++k) valid += all_valid(trial, k) ? 1 : 0;
      if (static_cast<double>(valid) >= kSmallestShareValid * static_cast<double>(count)) {
        windows.push_back({&trial, start, count});
        start += count - 1;
      } else {
        start += std::max<std::size_t>(1, count / 10);
      }
    }
  }
  return windows;
}

WindowResidual::WindowResidual(const model::Window& window, const model::Vehicle& vehicle) : window_{window} {
  const Trial& trial = *window.trial;
  for (int axis = 0; axis < 6; ++axis) {
    if (!vehicle.dof[static_cast<std::size_t>(axis)]) continue;
    if (axis < 3 ? !trial.observed.velocity : !trial.observed.rates) continue;
    const auto& valid = axis < 3 ? trial.velocity_valid : trial.rates_valid;
    for (std::size_t k = 0; k < window.count; ++k) {
      if (valid[window.start + k] != 0) rows_.push_back({static_cast<int>(k), axis});
    }
  }
}

bool WindowResidual::evaluate(const model::Model& model, const Vector6d& nu0, const Vector6d& sigma,
                              model::VelocityTrace& trace, Eigen::Ref<Eigen::VectorXd> residual) const {
  const bool finished = model::rollout(model, window_, nu0, trace);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row row = rows_[i];
    const double measured = window_.trial->nu[window_.start + static_cast<std::size_t>(row.sample)][row.axis];
    residual[static_cast<Eigen::Index>(i)] = (trace(row.axis, row.sample) - measured) / sigma[row.axis];
  }
  return finished;
}

void WindowResidual::parameter_jacobian(const model::Model& model, const ParameterMap& map, const Vector6d& nu0,
                                        const Vector6d& sigma, const Eigen::VectorXd& residual,
                                        Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  model::Model shifted = model;
  model::VelocityTrace trace;
  Eigen::VectorXd moved(rows());
  const Eigen::VectorXd x = map.pack(model);
  for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(map.size()); ++j) {
    const FreeParameter& free = map[static_cast<std::size_t>(j)];
    // Step away from a bound.
    const double step = (x[j] + kParameterStep) * free.scale > free.high ? -kParameterStep : kParameterStep;
    Eigen::VectorXd x_shifted = x;
    x_shifted[j] += step;
    map.unpack(x_shifted, shifted);
    evaluate(shifted, nu0, sigma, trace, moved);
    jacobian.col(j) = (moved - residual) / step;
  }
}

void WindowResidual::initial_jacobian(const model::Model& model, const Vector6d& nu0, const Vector6d& sigma,
                                      const Eigen::VectorXd& residual, Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  model::VelocityTrace trace;
  Eigen::VectorXd moved(rows());
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    if (!model.vehicle->dof[static_cast<std::size_t>(axis)]) {
      jacobian.col(axis).setZero();
      continue;
    }
    Vector6d shifted = nu0;
    shifted[axis] += kInitialStep;
    evaluate(model, shifted, sigma, trace, moved);
    jacobian.col(axis) = (moved - residual) / kInitialStep;
  }
}

}  // namespace fathom::identification

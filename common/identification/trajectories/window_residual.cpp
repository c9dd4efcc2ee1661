#include "common/identification/trajectories/window_residual.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::identification {
namespace {

// Relative to the parameter's scale: truncation and rounding of the rollout (1e-12) are both below 1e-4 of a column.
constexpr double kParameterStep = 1e-4;
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
    const auto count = static_cast<std::size_t>(std::max(1L, std::lround(length / trial.dt))) + 1;
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
    const auto first = rows();
    for (std::size_t k = 0; k < window.count; ++k) {
      if (valid[window.start + k] != 0) rows_.push_back({static_cast<int>(k), axis});
    }
    if (rows() > first) axes_.push_back({first, rows() - first});
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

void WindowResidual::jacobians(const model::Model& model, const ParameterMap& map, const Vector6d& nu0,
                               const Vector6d& sigma, const Eigen::VectorXd& residual, Eigen::MatrixXd& by_parameter,
                               Eigen::MatrixXd& by_initial) const {
  model::VelocityTrace trace;
  model::VelocityDerivatives derivatives;
  model::rollout_with_derivatives(model, window_, nu0, trace, derivatives);
  by_parameter.resize(rows(), static_cast<Eigen::Index>(map.size()));
  by_initial.resize(rows(), 6);
  for (Eigen::Index i = 0; i < rows(); ++i) {
    const Row row = rows_[static_cast<std::size_t>(i)];
    const auto all = derivatives.row(6 * row.sample + row.axis);
    by_initial.row(i) = all.tail<6>() / sigma[row.axis];
    for (std::size_t j = 0; j < map.size() && map[j].base >= 0; ++j) {
      by_parameter(i, static_cast<Eigen::Index>(j)) = all[map[j].base] * map[j].scale / sigma[row.axis];
    }
  }
  model::Model shifted = model;
  Eigen::VectorXd moved(rows());
  const Eigen::VectorXd x = map.pack(model);
  for (std::size_t j = 0; j < map.size(); ++j) {
    if (map[j].base >= 0) continue;
    const auto k = static_cast<Eigen::Index>(j);
    if (!map[j].sought) {
      by_parameter.col(k).setZero();
      continue;
    }
    // Step away from a bound.
    const double step = (x[k] + kParameterStep) * map[j].scale > map[j].high ? -kParameterStep : kParameterStep;
    Eigen::VectorXd x_shifted = x;
    x_shifted[k] += step;
    map.unpack(x_shifted, shifted);
    evaluate(shifted, nu0, sigma, trace, moved);
    by_parameter.col(k) = (moved - residual) / step;
  }
}

}  // namespace fathom::identification

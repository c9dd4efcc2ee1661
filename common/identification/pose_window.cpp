#include "common/identification/pose_window.hpp"

#include <limits>

#include "common/base/spatial.hpp"

namespace fathom::identification {
namespace {

constexpr double kParameterStep = 1e-4;  // of a parameter's scale
constexpr double kStartStep = 1e-5;      // m/s, rad/s, m, rad

}  // namespace

PoseWindow::PoseWindow(const model::Window& window, const model::Vehicle& vehicle) : window_{window} {
  const Trial& trial = *window.trial;
  const auto& dof = vehicle.dof;
  const bool moves = dof[0] || dof[1] || dof[2], tilts = dof[3] && dof[4];
  for (int signal = 0; signal < kSignals; ++signal) {
    const bool speed = signal < 6, place = !speed && signal < 9;
    const bool simulated = speed   ? dof[static_cast<std::size_t>(signal)]
                           : place ? moves
                                   : (signal == 11 ? dof[5] : tilts);
    const bool linear = signal < 3;
    const bool observed = speed   ? (linear ? trial.observed.velocity : trial.observed.rates)
                          : place ? trial.observed.position && trial.observed.attitude
                                  : trial.observed.attitude;
    if (simulated && (speed || observed)) free_.push_back(signal);
    if (!simulated || !observed) continue;
    const auto& valid = speed ? (linear ? trial.velocity_valid : trial.rates_valid) : trial.pose_valid;
    const auto first = rows();
    for (std::size_t k = 0; k < window.count; ++k) {
      if (valid[window.start + k] != 0) rows_.push_back({static_cast<int>(k), signal});
    }
    if (rows() > first) signals_.push_back({first, rows() - first});
  }
}

WindowStart PoseWindow::measured_start() const {
  WindowStart start = WindowStart::Zero();
  start.head<6>() = window_.trial->nu[window_.start];
  return start;
}

void PoseWindow::evaluate(const model::Model& model, const WindowStart& start,
                          Eigen::Ref<Eigen::VectorXd> residual) const {
  thread_local model::VelocityTrace nu;
  thread_local model::PoseTrace pose;
  if (!model::rollout(model, window_, start.head<6>(), {start.segment<3>(6), start.tail<3>()}, nu, pose)) {
    residual.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  const Trial& trial = *window_.trial;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    const auto k = static_cast<std::size_t>(row.sample), at = window_.start + k;
    double& out = residual[static_cast<Eigen::Index>(i)];
    if (row.signal < 6) {
      out = nu(row.signal, row.sample) - trial.nu[at][row.signal];
    } else if (row.signal < 9) {
      out = pose.p_WB(row.signal - 6, row.sample) - trial.p_WB[at][row.signal - 6];
    } else {
      out = rotation_vector_from_quaternion(pose.q_WB[k] * trial.q_WB[at].conjugate())[row.signal - 9];
    }
  }
}

Eigen::MatrixXd PoseWindow::jacobian(const model::Model& model, const ParameterMap& map,
                                     std::span<const Eigen::Index> moving, const WindowStart& start,
                                     const Eigen::VectorXd& residual) const {
  const auto n = static_cast<Eigen::Index>(map.size());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows(), n + static_cast<Eigen::Index>(free_.size()));
  const Eigen::VectorXd x = map.pack(model);
  Eigen::VectorXd moved(rows());
  model::Model shifted = model;
  for (const Eigen::Index j : moving) {
    const FreeParameter& free = map[static_cast<std::size_t>(j)];
    const double step = (x[j] + kParameterStep) * free.scale > free.high ? -kParameterStep : kParameterStep;
    Eigen::VectorXd x_shifted = x;
    x_shifted[j] += step;
    map.unpack(x_shifted, shifted);
    evaluate(shifted, start, moved);
    jacobian.col(j) = (moved - residual) / step;
  }
  for (std::size_t s = 0; s < free_.size(); ++s) {
    WindowStart other = start;
    other[free_[s]] += kStartStep;
    evaluate(model, other, moved);
    jacobian.col(n + static_cast<Eigen::Index>(s)) = (moved - residual) / kStartStep;
  }
  return jacobian;
}

std::vector<PoseWindow> pose_windows(const model::Vehicle& vehicle, std::span<const Trial> trials, double length) {
  std::vector<PoseWindow> windows;
  for (const model::Window& window : cut_windows(trials, length)) {
    if (!window.trial->observed.attitude) continue;
    PoseWindow one{window, vehicle};
    if (one.rows() > 0) windows.push_back(std::move(one));
  }
  return windows;
}

}  // namespace fathom::identification

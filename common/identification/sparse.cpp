#include "common/identification/sparse.hpp"

#include <algorithm>

namespace fathom::identification {
namespace {

/// Mean of the valid velocities (first three or last three components) near `centre`; its own when it is not valid.
Eigen::Vector3d mean_near(const Trial& trial, const std::vector<std::uint8_t>& valid, std::size_t centre,
                          std::size_t half, Eigen::Index first) {
  if (valid[centre] == 0) return trial.nu[centre].segment<3>(first);
  // Pairs around the centre: a mean of one side only would be early or late.
  Eigen::Vector3d sum = trial.nu[centre].segment<3>(first);
  double count = 1.0;
  for (std::size_t i = 1; i <= half && i <= centre && centre + i < trial.size(); ++i) {
    if (valid[centre - i] == 0 || valid[centre + i] == 0) break;
    sum += trial.nu[centre - i].segment<3>(first) + trial.nu[centre + i].segment<3>(first);
    count += 2.0;
  }
  return sum / count;
}

Eigen::VectorXd mean_input(const Trial& trial, std::size_t centre, std::size_t half) {
  Eigen::VectorXd sum = trial.input[centre];
  double count = 1.0;
  for (std::size_t i = 1; i <= half && i <= centre && centre + i < trial.size(); ++i) {
    sum += trial.input[centre - i] + trial.input[centre + i];
    count += 2.0;
  }
  return sum / count;
}

/// Mean over the next `step` samples' steps, and of that what the velocities near `centre` felt of it.
Eigen::VectorXd mean_step(const std::vector<Eigen::VectorXd>& held, std::size_t centre, std::size_t half,
                          std::size_t step) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(held[centre].size());
  double count = 0.0;
  const auto add = [&](std::size_t from) {
    for (std::size_t i = from; i < std::min(from + step, held.size()); ++i, count += 1.0) sum += held[i];
  };
  add(centre);
  for (std::size_t i = 1; i <= half && i <= centre && centre + i < held.size(); ++i) {
    add(centre - i);
    add(centre + i);
  }
  return sum / count;
}

std::vector<Eigen::VectorXd> next_of(const std::vector<Eigen::VectorXd>& input) {
  std::vector<Eigen::VectorXd> next(input.begin() + 1, input.end());
  next.push_back(input.back());
  return next;
}

}  // namespace

Trial sparse(const Trial& trial, double dt) {
  const auto step = static_cast<std::size_t>(dt / trial.dt + 1e-9);
  if (step < 2) return trial;
  Trial out{.name = trial.name, .dt = trial.dt * static_cast<double>(step), .observed = trial.observed};
  out.input_is_wrench = trial.input_is_wrench;
  out.input_step = trial.input_step;
  out.input_averaged = trial.input_averaged;
  out.nu_sigma = trial.nu_sigma;
  const auto& held = trial.held.empty() ? trial.input : trial.held;
  const auto& told = trial.told.empty() && !trial.input_averaged ? next_of(trial.input) : trial.told;
  for (std::size_t k = 0; k < trial.size(); k += step) {
    out.t.push_back(trial.t[k]);
    out.p_WB.push_back(trial.p_WB[k]);
    out.q_WB.push_back(trial.q_WB[k]);
    Vector6d nu;
    nu << mean_near(trial, trial.velocity_valid, k, step / 2, 0), mean_near(trial, trial.rates_valid, k, step / 2, 3);
    out.nu.push_back(nu);
    out.pose_valid.push_back(trial.pose_valid[k]);
    out.velocity_valid.push_back(trial.velocity_valid[k]);
    out.rates_valid.push_back(trial.rates_valid[k]);
    out.input.push_back(mean_input(trial, k, step / 2));
    out.held.push_back(mean_step(held, k, step / 2, step));
    if (!told.empty()) out.told.push_back(mean_step(told, k, step / 2, step));
    if (!trial.voltage.empty()) out.voltage.push_back(trial.voltage[k]);
  }
  return out;
}

}  // namespace fathom::identification

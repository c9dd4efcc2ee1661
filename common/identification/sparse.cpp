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

/// Whether nothing was guessed of what the means and the next step at `centre` are made of.
std::uint8_t all_known(const Trial& trial, std::size_t centre, std::size_t step) {
  const auto begin = trial.input_valid.begin() + static_cast<std::ptrdiff_t>(centre - std::min(centre, step / 2));
  const auto end = trial.input_valid.begin() + static_cast<std::ptrdiff_t>(std::min(centre + step, trial.size()));
  return std::find(begin, end, std::uint8_t{0}) == end ? 1 : 0;
}

/// Of the parts of the next `step` samples' steps, `together` at a time, what the velocities near `centre` felt of
/// them.
void add_parts(const std::vector<Eigen::VectorXd>& held, std::size_t parts, std::size_t centre, std::size_t half,
               std::size_t step, std::size_t together, std::vector<Eigen::VectorXd>& out) {
  const std::size_t samples = held.size() / parts;
  for (std::size_t part = 0; part < parts * step; part += together) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(held[centre].size());
    double count = 0.0;
    const auto add = [&](std::size_t from) {
      const std::size_t begin = parts * from + part;
      for (std::size_t i = begin; i < std::min(begin + together, held.size()); ++i, count += 1.0) sum += held[i];
    };
    add(centre);
    for (std::size_t i = 1; i <= half && i <= centre && centre + i < samples; ++i) {
      add(centre - i);
      add(centre + i);
    }
    out.emplace_back(count > 0.0 ? Eigen::VectorXd(sum / count) : held.back());
  }
}

/// How many of `parts` to take together: as many as the vehicle lets be averaged, and the same everywhere.
std::size_t parts_together(std::size_t parts, double length, double longest) {
  std::size_t together = longest > 0.0 ? 1 : parts;
  for (std::size_t n = 2; n <= parts && longest > 0.0; ++n) {
    if (parts % n == 0 && static_cast<double>(n) * length < longest * (1.0 + 1e-9)) together = n;
  }
  return together;
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
  out.input_part = trial.input_part;
  out.nu_sigma = trial.nu_sigma;
  out.column_units = trial.column_units;
  const auto& held = trial.held.empty() ? trial.input : trial.held;
  const auto& told = trial.told.empty() ? next_of(trial.input) : trial.told;
  const std::size_t parts = trial.parts();
  const std::size_t together = parts_together(parts * step, trial.dt / static_cast<double>(parts), trial.input_part);
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
    if (!trial.input_valid.empty()) out.input_valid.push_back(all_known(trial, k, step));
    add_parts(held, parts, k, step / 2, step, together, out.held);
    add_parts(told, parts, k, step / 2, step, together, out.told);
    if (!trial.voltage.empty()) out.voltage.push_back(trial.voltage[k]);
    if (!trial.columns.empty()) out.columns.push_back(trial.columns[k]);
  }
  return out;
}

}  // namespace fathom::identification

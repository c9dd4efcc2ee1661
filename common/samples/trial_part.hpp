// A part of a run, as a trial of its own.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>

#include "common/samples/trial.hpp"

namespace fathom {

/// Samples [from, to) of a run, under that name; its time goes on. `to` at most its size.
[[nodiscard]] inline Trial part_of(const Trial& trial, std::size_t from, std::size_t to, const std::string& name) {
  const auto cut = [&](const auto& all, std::size_t each = 1) {
    using Vector = std::decay_t<decltype(all)>;
    if (all.empty()) return Vector{};
    return Vector(all.begin() + static_cast<std::ptrdiff_t>(each * from),
                  all.begin() + static_cast<std::ptrdiff_t>(each * to));
  };
  Trial part;
  part.name = name;
  part.dt = trial.dt;
  part.observed = trial.observed;
  part.t = cut(trial.t);
  part.p_WB = cut(trial.p_WB);
  part.q_WB = cut(trial.q_WB);
  part.nu = cut(trial.nu);
  part.pose_valid = cut(trial.pose_valid);
  part.velocity_valid = cut(trial.velocity_valid);
  part.rates_valid = cut(trial.rates_valid);
  part.input = cut(trial.input);
  part.input_valid = cut(trial.input_valid);
  part.input_is_wrench = trial.input_is_wrench;
  part.input_step = trial.input_step;
  part.input_averaged = trial.input_averaged;
  part.input_part = trial.input_part;
  part.held = cut(trial.held, trial.parts());
  part.told = cut(trial.told, trial.parts());
  part.voltage = cut(trial.voltage);
  part.columns = cut(trial.columns);
  part.column_units = trial.column_units;
  part.nu_sigma = trial.nu_sigma;
  return part;
}

}  // namespace fathom

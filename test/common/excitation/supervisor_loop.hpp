// Plant and supervisor, and an operator who gives orders.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "common/excitation/supervisor.hpp"
#include "test/common/excitation/tank_run.hpp"

namespace fathom::excitation {

using test::order_to_arm;
using test::TankPlant;

/// No identifier runs here.
inline test::TankSettings settings_without_model() {
  test::TankSettings settings = test::tank_settings();
  settings.supervisor.model_patience = 0.0;
  return settings;
}

struct Loop {
  test::TankSettings settings;
  TankPlant plant{settings.vehicle, {}};
  Supervisor supervisor{test::ready(settings.supervisor, settings.vehicle)};
  std::optional<Excitation> said{};
  bool valid{true};
  bool heard{true};  // does STATE come at all?
  double largest_command{};
  int commands{};
  std::int64_t armed_by{};  // of the last command

  explicit Loop(test::TankSettings from = settings_without_model()) : settings{std::move(from)} {
    plant.place({0.2, -0.1, 0.75});
  }
  void run(double seconds) {
    largest_command = 0.0;
    commands = 0;
    for (int k = 0; k < static_cast<int>(100 * seconds); ++k) {
      StateEstimate state = plant.state();
      state.valid = valid;
      if (heard) {
        const auto& output = supervisor.step(state);
        if (output.command) {
          plant.command(*output.command);
          armed_by = output.command->armed_by;
          largest_command = std::max(largest_command, output.command->tau.cwiseAbs().maxCoeff());
          ++commands;
        }
        if (output.excitation) said = output.excitation;
      }
      plant.step();
    }
  }
  void arm() { supervisor.hear(order_to_arm(plant.utime())); }
  void order(const std::string& word) {
    Operator o = order_to_arm(plant.utime());
    o.enable = false;
    o.order = word;
    supervisor.hear(o);
  }
  [[nodiscard]] bool thrust() const { return plant.applied().tau.norm() > 1e-9; }
};

/// A model with which the mode may be left at once.
inline ModelEstimate finished(const model::Vehicle& vehicle, Utime utime) {
  ModelEstimate model{.utime = utime};
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    model.parameters.push_back({vehicle.parameters[i], vehicle.priors[i].mean, 0.01, ""});
  }
  for (const char* mode : {"yaw", "surge", "sway", "heave", "total"}) model.modes.push_back({mode, 0.01, 0.01});
  model.residual_ratio.setOnes();
  return model;
}

}  // namespace fathom::excitation

#include "common/diagnosis/seen_trial.hpp"

namespace fathom::diagnosis {

void SeenTrial::begin(const model::Allocation& allocation) {
  clear();
  allocation_ = allocation;
}

void SeenTrial::clear() {
  kept_ = {};
  forces_ = {};
  commands_ = {};
}

void SeenTrial::keep(const LiveSample& sample) {
  const Eigen::Index actuators = allocation_.cols();
  kept_.push_back({.utime = sample.motion.utime,
                   .commands_from = sample.commands_from.value_or(0),
                   .nu = sample.motion.nu,
                   .p_WB = sample.p_WB,
                   .voltage = sample.voltage,
                   .q_WB = sample.q_WB,
                   .first_command = static_cast<std::uint32_t>(commands_.size()),
                   .commands = static_cast<std::uint16_t>(sample.commands.size()),
                   .valid = sample.motion.valid,
                   .has_position = sample.has_position,
                   .grid_begins = sample.commands_from.has_value()});
  for (Eigen::Index k = 0; k < actuators; ++k) forces_.push_back(sample.motion.valid ? sample.force[k] : 0.0);
  for (const Eigen::VectorXd& command : sample.commands)
    commands_.insert(commands_.end(), command.begin(), command.end());
}

void SeenTrial::get(std::size_t i, LiveSample& sample) const {
  const Kept& kept = kept_[i];
  const auto actuators = static_cast<std::size_t>(allocation_.cols());
  sample.motion = {.utime = kept.utime, .nu = kept.nu, .down_B = down_of(kept.q_WB), .valid = kept.valid};
  sample.p_WB = kept.p_WB;
  sample.q_WB = kept.q_WB;
  sample.voltage = kept.voltage;
  sample.has_position = kept.has_position;
  sample.commands_from.reset();
  if (kept.grid_begins) sample.commands_from = kept.commands_from;
  sample.force.resize(kept.valid ? allocation_.cols() : 0);
  for (Eigen::Index k = 0; k < sample.force.size(); ++k)
    sample.force[k] = forces_[i * actuators + static_cast<std::size_t>(k)];
  if (kept.valid) sample.motion.tau = allocation_ * sample.force;
  sample.commands.resize(kept.commands);
  auto from = commands_.begin() + static_cast<std::ptrdiff_t>(kept.first_command);
  for (Eigen::VectorXd& command : sample.commands) {
    command.resize(allocation_.cols());
    for (double& force : command) force = *from++;
  }
}

void SeenTrial::turn(const Eigen::Matrix3d& velocities, const Eigen::Matrix3d& rates) {
  for (Kept& kept : kept_) kept.nu << (velocities * kept.nu.head<3>()).eval(), (rates * kept.nu.tail<3>()).eval();
}

}  // namespace fathom::diagnosis

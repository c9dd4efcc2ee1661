#include "common/drafts/ardusub_mixer.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace fathom::drafts {

// libraries/AP_Motors/AP_Motors6DOF.cpp of ArduPilot says how: three ways, by frame.
ArdusubMixer::ArdusubMixer(const std::string& frame, double coupling, const std::vector<int>& reversed)
    : frame_{&ardusub_frame(frame)},
      coupling_{frame == "vectored" ? coupling : 0.0},
      direction_(frame_->motors.size(), 1.0) {
  for (const int number : reversed) {
    if (number < 1 || static_cast<std::size_t>(number) > direction_.size()) {
      throw InputError("frame " + frame + " has motors 1 to " + std::to_string(direction_.size()) + ", none " +
                       std::to_string(number));
    }
    direction_[static_cast<std::size_t>(number) - 1] = -1.0;
  }
}

// Of frame vectored: the motors that would draw water off the vertical ones are held back while these push.
double ArdusubMixer::ahead_of(const FrameMotor& motor, const Sticks& sticks) const {
  if (coupling_ == 0.0 || motor.forward * sticks.forward <= 0.0) return sticks.forward;
  const double limit = std::max(0.0, 1.0 - coupling_ * std::abs(sticks.throttle));
  return std::clamp(sticks.forward, -limit, limit);
}

void ArdusubMixer::mix(const Sticks& sticks, std::span<double> commands) const {
  const auto vertical = [&](const FrameMotor& m) {
    return sticks.roll * m.roll + sticks.pitch * m.pitch + sticks.throttle * m.throttle;
  };
  const auto horizontal = [&](const FrameMotor& m) {
    return sticks.yaw * m.yaw + ahead_of(m, sticks) * m.forward + sticks.lateral * m.lateral;
  };
  // Of frame vectored-6dof alone, vertical and horizontal motors each share what is too much among themselves.
  double most_vertical = 1.0, most_horizontal = 1.0;
  if (frame_->name == "vectored-6dof") {
    for (const FrameMotor& motor : frame_->motors) {
      most_vertical = std::max(most_vertical, std::abs(vertical(motor)));
      most_horizontal = std::max(most_horizontal, std::abs(horizontal(motor)));
    }
  }
  for (std::size_t i = 0; i < frame_->motors.size(); ++i) {
    const FrameMotor& motor = frame_->motors[i];
    const double both = vertical(motor) / most_vertical + horizontal(motor) / most_horizontal;
    commands[i] = std::clamp(direction_[i] * both, -1.0, 1.0);
  }
}

}  // namespace fathom::drafts

#include "common/model/motion.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::model {

InputSignal::InputSignal(double t0, double dt, std::span<const Eigen::VectorXd> samples,
                         std::span<const Eigen::VectorXd> held, std::span<const Eigen::VectorXd> told,
                         const InputTiming& timing)
    : t0_{t0}, dt_{dt}, later_{timing.hold * timing.step}, part_{dt}, samples_{samples} {
  mixed_ = !held.empty() && held.size() == told.size() && (timing.averaged || held.size() > samples.size());
  if (mixed_) {
    // Half of held and half of told is the mean along straight lines from input to input.
    held_share_ = 0.5 + timing.hold;
    part_ = dt * static_cast<double>(samples.size()) / static_cast<double>(held.size());
    held_ = held;
    told_ = told;
    return;
  }
  held_share_ = 2.0 * std::abs(timing.hold);
  held_ = timing.hold < 0.0 ? told : held;
  if (!held_.empty()) return;
  held_ = samples;
  if (timing.hold < 0.0) ahead_ = timing.step / dt;
}

void InputSignal::line(double t, ActuatorForces& force) const {
  const double last = static_cast<double>(samples_.size() - 1);
  const double position = std::clamp((t - t0_) / dt_, 0.0, last);
  const auto index = static_cast<std::size_t>(std::min(std::floor(position), std::max(last - 1.0, 0.0)));
  const double share = position - static_cast<double>(index);
  const std::size_t next = std::min(index + 1, samples_.size() - 1);
  force = (1.0 - share) * samples_[index] + share * samples_[next];
}

void InputSignal::at(double t, ActuatorForces& force) const { line(t - later_, force); }

void InputSignal::now(double t, ActuatorForces& force) const {
  constexpr double kRounding = 1e-6;  // of dt: at a jump, the force after it
  if (mixed_) {
    const double last = static_cast<double>(held_.size() - 1);
    const auto part = static_cast<std::size_t>(std::clamp(std::floor((t - t0_) / part_ + kRounding), 0.0, last));
    force = held_share_ * held_[part] + (1.0 - held_share_) * told_[part];
    return;
  }
  if (held_share_ == 0.0) return line(t - later_, force);
  const double last = static_cast<double>(held_.size() - 1);
  const double place = std::clamp(std::floor((t - t0_) / dt_ + kRounding) + ahead_, 0.0, last);
  const auto index = static_cast<std::size_t>(place);
  const double share = std::max(place - static_cast<double>(index), 0.0);
  const std::size_t next = std::min(index + 1, held_.size() - 1);
  if (held_share_ == 1.0) {
    force = (1.0 - share) * held_[index] + share * held_[next];
    return;
  }
  line(t, force);
  force += held_share_ * ((1.0 - share) * held_[index] + share * held_[next] - force);
}

}  // namespace fathom::model

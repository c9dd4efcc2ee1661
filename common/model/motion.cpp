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

void InputSignal::at(double t, ActuatorForces& force) const { line(t - offset_ - later_, force); }

/// Of the force at t in the inputs that are held, in their steps; at a jump, the one after it.
double InputSignal::place(double t) const {
  constexpr double kRounding = 1e-6;
  return mixed_ ? std::floor((t - t0_) / part_ + kRounding) : std::floor((t - t0_) / dt_ + kRounding) + ahead_;
}

/// Of the two next to a place: the mean over a step that begins between them.
void InputSignal::mixture(double place, ActuatorForces& force) const {
  const double last = static_cast<double>(held_.size() - 1);
  place = std::clamp(place, 0.0, last);
  const auto index = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(index);
  if (share == 0.0) {  // what now() asks for
    force = held_[index];
    if (mixed_ && held_share_ != 1.0) force += (1.0 - held_share_) * (told_[index] - held_[index]);
    return;
  }
  const std::size_t next = std::min(index + 1, held_.size() - 1);
  if (mixed_) {
    force = held_share_ * ((1.0 - share) * held_[index] + share * held_[next]) +
            (1.0 - held_share_) * ((1.0 - share) * told_[index] + share * told_[next]);
  } else {
    force = (1.0 - share) * held_[index] + share * held_[next];
  }
}

void InputSignal::change(double t, ActuatorForces& difference) const {
  ActuatorForces before;
  at(t - 0.5 * dt_, before);
  at(t + 0.5 * dt_, difference);
  difference -= before;
  if (!mixed_) difference *= 1.0 - held_share_;
}

void InputSignal::now(double t, ActuatorForces& force) const { ago(t, 0.0, force); }

void InputSignal::ago(double t, double later, ActuatorForces& force) const {
  later += offset_;
  if (mixed_) return mixture(place(t) - later / part_, force);
  if (held_share_ == 0.0) return line(t - later - later_, force);
  const double held = place(t) - later / dt_;
  if (held_share_ == 1.0) return mixture(held, force);
  ActuatorForces straight;
  line(t - later, straight);
  mixture(held, force);
  force = held_share_ * force + (1.0 - held_share_) * straight;
}

}  // namespace fathom::model

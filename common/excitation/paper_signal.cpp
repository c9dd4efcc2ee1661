#include "common/excitation/paper_signal.hpp"

#include <cmath>
#include <numbers>

namespace fathom::excitation {

PaperSignal::PaperSignal(const PaperSignalSettings& settings, std::uint64_t seed)
    : settings_{settings}, random_{seed}, interval_count_{settings.interval_steps} {}

void PaperSignal::draw() {
  const double low = settings_.low_share * settings_.largest;
  if (submode_ == 0) {
    frequency_ = random_.uniform(0.0, settings_.highest_frequency);
    amplitude_ = settings_.random_amplitude ? random_.uniform(low, settings_.largest) : settings_.largest;
  } else if (submode_ == 1) {
    amplitude_ = random_.uniform(0.0, low) * random_.sign();
  } else {
    amplitude_ = random_.uniform(low, settings_.largest) * random_.sign();
  }
}

double PaperSignal::step(double dt) {
  if (++submode_count_ >= settings_.submode_steps) {
    submode_ = (submode_ + 1) % 3;
    submode_count_ = 0;
    interval_count_ = settings_.interval_steps;
  }
  if (interval_count_ >= settings_.interval_steps) {
    draw();
    interval_count_ = 0;
  }
  ++interval_count_;
  if (submode_ != 0) return amplitude_;
  phase_ = std::fmod(phase_ + 2.0 * std::numbers::pi * frequency_ * dt, 2.0 * std::numbers::pi);
  return amplitude_ * std::cos(phase_);
}

// A cosine turns by half a period, so that it goes on from the other side.
void PaperSignal::turn() {
  if (submode_ == 0) {
    phase_ += std::numbers::pi;
  } else {
    amplitude_ = -amplitude_;
  }
}

}  // namespace fathom::excitation

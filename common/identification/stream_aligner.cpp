#include "common/identification/stream_aligner.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace fathom::identification {
namespace {

constexpr double kInputHistory = 5.0;     // s kept before the newest input: far more than channels lag each other
constexpr std::size_t kTidyFrom = 64;     // samples used up before the rest is moved to the front
constexpr double kVoltageHistory = 60.0;  // s; a battery that reports more seldom than that is not listened to

}  // namespace

bool StreamAligner::push(const StateEstimate& state) {
  if (last_state_ && state.utime <= *last_state_) return false;
  last_state_ = state.utime;
  pending_.push_back(state);
  return true;
}

bool StreamAligner::push_input(Utime utime, const model::ActuatorForces& input) {
  if (!inputs_.empty() && utime <= inputs_.back().utime) return false;
  inputs_.push_back({utime, input});
  return true;
}

bool StreamAligner::push_voltage(Utime utime, double voltage) {
  if (!voltages_.empty() && utime <= voltages_.back().utime) return false;
  voltages_.push_back({utime, voltage});
  return true;
}

// A state's fate depends on message times alone: it is used when it lies between two inputs no further apart than
// max_input_gap. While no input at or after it is here, it waits, until the newest state says that one can only come
// too late: with channels lagging each other by max_skew at most, every input up to max_skew before that state has
// arrived.
bool StreamAligner::settled(Utime utime, bool covered) const {
  const bool waited = seconds_between(utime, *last_state_) > settings_.max_skew;
  if (!covered) {
    const bool too_far = inputs_.empty() || seconds_between(inputs_.back().utime, *last_state_) >
                                                settings_.max_input_gap + settings_.max_skew;
    if (!waited || !too_far) return false;
  }
  const bool voltage_known = !settings_.voltage || (!voltages_.empty() && voltages_.back().utime >= utime);
  return voltage_known || waited;
}

std::optional<StreamAligner::Aligned> StreamAligner::next(bool all) {
  if (done_ == pending_.size()) {
    pending_.clear();
    done_ = 0;
    return std::nullopt;
  }
  const StateEstimate& state = pending_[done_];
  const bool covered = !inputs_.empty() && inputs_.back().utime >= state.utime;
  if (!all && !settled(state.utime, covered)) return std::nullopt;
  Aligned aligned{.state = state, .input = std::nullopt};
  if (covered) aligned.input = input_at(state.utime);
  if (aligned.input && before_ && !settings_.interpolate) make_up(*before_, state.utime, *aligned.input);
  before_ = state.utime;
  const auto after = std::upper_bound(voltages_.begin(), voltages_.end(), state.utime,
                                      [](Utime time, const Voltage& v) { return time < v.utime; });
  if (after != voltages_.begin() && seconds_between(std::prev(after)->utime, state.utime) < kVoltageHistory) {
    aligned.voltage = std::prev(after)->value;
  }
  ++done_;
  forget();
  return aligned;
}

std::optional<model::ActuatorForces> StreamAligner::input_at(Utime utime) const {
  const auto after = std::lower_bound(inputs_.begin(), inputs_.end(), utime,
                                      [](const Input& input, Utime time) { return input.utime < time; });
  if (after == inputs_.end()) return std::nullopt;
  if (after->utime == utime && (settings_.interpolate || after == inputs_.begin())) return after->value;
  if (after == inputs_.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const double gap = seconds_between(before->utime, after->utime);
  // Where a held input jumps, its mean is right for whoever sums samples by trapezoids; either side is half a step off.
  const bool jump = after->utime == utime;
  if (gap > settings_.max_input_gap) return jump ? std::optional{after->value} : std::nullopt;
  if (jump) return model::ActuatorForces{0.5 * (before->value + after->value)};
  if (!settings_.interpolate) return before->value;
  return model::ActuatorForces{before->value +
                               (seconds_between(before->utime, utime) / gap) * (after->value - before->value)};
}

// Trapezoids take a jump between two states as one in the middle. What they miss of the integral is added to the later
// state: commands that come just behind the states would else count as half a step late.
void StreamAligner::make_up(Utime from, Utime to, model::ActuatorForces& input) const {
  const double step = seconds_between(from, to);
  if (step > settings_.max_input_gap) return;
  const auto later = [](Utime time, const Input& each) { return time < each.utime; };
  auto jump = std::upper_bound(inputs_.begin(), inputs_.end(), from, later);
  if (jump == inputs_.begin()) return;
  for (; jump != inputs_.end() && jump->utime < to; ++jump) {
    const double missed = seconds_between(jump->utime, to) / step - 0.5;
    input += missed * (jump->value - std::prev(jump)->value);
  }
}

// Seldom and many at once, since this moves what is kept.
void StreamAligner::forget() {
  const Utime now = pending_[done_ - 1].utime;
  if (done_ >= kTidyFrom && 2 * done_ > pending_.size()) {
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(done_));
    done_ = 0;
  }
  const auto tidy = [now](auto& samples, double history) {
    std::size_t old = 0;
    while (old + 2 < samples.size() && seconds_between(samples[old + 1].utime, now) > history) ++old;
    if (old >= kTidyFrom && 2 * old > samples.size()) {
      samples.erase(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(old));
    }
  };
  if (inputs_.size() > kTidyFrom) tidy(inputs_, kInputHistory);
  if (voltages_.size() > kTidyFrom) tidy(voltages_, kVoltageHistory);
}

void StreamAligner::reset() {
  pending_.clear();
  done_ = 0;
  inputs_.clear();
  voltages_.clear();
  last_state_.reset();
  before_.reset();
}

}  // namespace fathom::identification

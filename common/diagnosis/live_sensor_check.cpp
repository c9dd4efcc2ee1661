#include "common/diagnosis/live_sensor_check.hpp"

#include <span>
#include <string>

#include "common/diagnosis/sensor_faults.hpp"
#include "common/estimation/consistency.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kFirstLook = 60.0;  // s of the trial
constexpr double kWider = 2.0;       // of the trial's length at the look before
constexpr double kKept = 600.0;      // s, as of the motion
constexpr double kSkew = 1.0;        // s by which channels may lag each other
constexpr double kThinking = 20.0;   // s from a look to its answer; it takes about one

const std::string kReference = "pose_capture";  // STATE, here: what the estimator makes of all sensors is none of them

template <class Samples>
void forget(Samples& samples, Utime now) {
  while (!samples.empty() && seconds_between(samples.front().utime, now) > kKept) samples.pop_front();
}

std::vector<EffectEvidence> look(const Recording& recording) {
  std::vector<EffectEvidence> faults;
  for (const EffectFound& fault : sensor_faults(estimation::check_consistency(std::span(&recording, 1)).findings)) {
    if (fault.variant == kReference) continue;
    EffectEvidence& evidence =
        faults.emplace_back(EffectEvidence{.name = fault.name, .log_odds = fault.log_odds, .variant = fault.variant});
    for (const NamedValue& number : fault.parameters) evidence.numbers.push_back(number.value);
  }
  return faults;
}

}  // namespace

void LiveSensorCheck::hear(const Ahrs& ahrs) {
  if (!ahrs_.empty() && ahrs.utime <= ahrs_.back().utime) return;
  ahrs_.push_back(ahrs);
  ahrs_.back().has_specific_force = false;  // STATE rests on it already
  forget(ahrs_, ahrs.utime);
}

void LiveSensorCheck::hear(const Dvl& dvl) {
  if (!dvl_.empty() && dvl.utime <= dvl_.back().utime) return;
  dvl_.push_back(dvl);
  forget(dvl_, dvl.utime);
}

void LiveSensorCheck::step(const StateEstimate& state) {
  pose_.push_back({.utime = state.utime, .p_WB = state.p_WB, .q_WB = state.q_WB, .valid = state.valid});
  forget(pose_, state.utime);
  if (!first_) {
    first_ = state.utime;
    next_look_ = kFirstLook;
  }
  if (look_.valid() && state.utime >= due_) take();
  const double shown = seconds_between(*first_, state.utime);
  if (look_.valid() || shown < next_look_) return;
  next_look_ = kWider * shown;
  due_ = utime_after(state.utime, kThinking);
  look_ = std::async(std::launch::async, look, until(state.utime));
}

/// What every channel has told by then, however late it is.
Recording LiveSensorCheck::until(Utime now) const {
  const Utime end = utime_after(now, -kSkew);
  const auto copy = [&](const auto& from, auto& to) {
    for (const auto& sample : from) {
      if (sample.utime <= end) to.push_back(sample);
    }
  };
  Recording recording{.name = "trial"};
  recording.one_estimate = dvl_.empty();
  copy(pose_, recording.pose_capture);
  copy(ahrs_, recording.ahrs);
  copy(dvl_, recording.dvl);
  return recording;
}

void LiveSensorCheck::take() { faults_ = look_.get(); }

void LiveSensorCheck::finish() {
  if (look_.valid()) take();
  if (!pose_.empty()) faults_ = look(until(utime_after(pose_.back().utime, kSkew)));
}

void LiveSensorCheck::reset() {
  if (look_.valid()) (void)look_.get();
  *this = LiveSensorCheck{};
}

}  // namespace fathom::diagnosis

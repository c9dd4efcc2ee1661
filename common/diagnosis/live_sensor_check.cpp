#include "common/diagnosis/live_sensor_check.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>
#include <system_error>
#include <utility>

#include "common/base/spatial.hpp"
#include "common/diagnosis/moved.hpp"
#include "common/preflight/sensor_faults.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kFirstLook = 60.0;  // s of the trial
constexpr double kWider = 2.0;       // of the trial's length at the look before
constexpr double kKept = 300.0;      // s: more would not make a delay better known than the estimator lets it be
constexpr double kSkew = 1.0;        // s by which channels may lag each other
constexpr double kMargin = 30.0;     // s that a sensor may be ahead of STATE, or behind, when a log is played quickly
constexpr double kThinking = 20.0;   // s from a look to its answer; it takes less than one
constexpr double kGap = 5.0;         // s without STATE: another trial begins
constexpr double kLeap = 1.0;        // s back: the clock is another, or was wild before

/// "dvl" of "dvl.delay", "gyro.p" of "gyro.p.error".
std::string signal_of(const NamedValue& number) { return number.name.substr(0, number.name.rfind('.')); }
std::string group_of(const std::string& signal) { return signal.substr(0, signal.find('.')); }

/// As many numbers as the effect has, in their order.
std::vector<double> numbers_of(const EffectFound& fault, const NamedValue& number) {
  if (fault.name != "lever_arm") return {number.value};
  std::vector<double> xyz(3, 0.0);
  for (const NamedValue& one : fault.parameters)
    xyz[static_cast<std::size_t>(std::clamp(one.name.back() - 'x', 0, 2))] = one.value;
  return xyz;
}

}  // namespace

LiveSensorCheck::LiveSensorCheck(estimation::Corrections corrections, std::optional<consistency::FlowWitnesses> flow)
    : corrections_{std::move(corrections)}, flow_{std::move(flow)} {}

void LiveSensorCheck::hear(const Ahrs& ahrs) {
  if (!ahrs.has_rates) return;
  keep(rates_, {utime_after(ahrs.utime, corrections_.gyro_shift),
                corrections_.gyro.matrix() * ahrs.w_WB_B + corrections_.gyro.bias});
}

void LiveSensorCheck::hear(const Dvl& dvl) {
  if (!dvl.valid || dvl.held) return;
  keep(velocities_, {utime_after(dvl.utime, corrections_.dvl_shift),
                     corrections_.dvl.matrix() * dvl.v_WB_B + corrections_.dvl.bias});
}

void LiveSensorCheck::hear(const TagPose& tag) { hear_picture(tag); }
void LiveSensorCheck::hear(const OpticalFlow& flow) { hear_picture(flow); }

template <class Message>
void LiveSensorCheck::hear_picture(const Message& message) {
  const bool wild = !states_.empty() && std::abs(seconds_between(states_.back().utime, message.utime)) > kMargin;
  if (flow_ && !wild) flow_->hear(message);
}

/// A clock that is wild for a moment costs no more than it leapt: what is newer than a stamp that goes back is let go,
/// and what is far from STATE is not heard at all.
void LiveSensorCheck::keep(std::deque<Sample>& samples, const Sample& sample) const {
  if (!states_.empty() && std::abs(seconds_between(states_.back().utime, sample.utime)) > kMargin) return;
  if (!samples.empty() && seconds_between(sample.utime, samples.back().utime) > kLeap) {
    while (!samples.empty() && samples.back().utime >= sample.utime) samples.pop_back();
  }
  if (!samples.empty() && sample.utime <= samples.back().utime) return;
  samples.push_back(sample);
  while (seconds_between(samples.front().utime, sample.utime) > kKept + 2.0 * kMargin) samples.pop_front();
}

void LiveSensorCheck::step(const StateEstimate& state) {
  if (!states_.empty() && seconds_between(states_.back().utime, state.utime) > kGap) {
    states_.clear();
    first_.reset();
  }
  states_.push_back(consistency::motion_of(state));
  while (seconds_between(states_.front().utime, state.utime) > kKept + kMargin) states_.pop_front();
  if (flow_) flow_->forget_before(utime_after(state.utime, -(kKept + kMargin)));
  if (!first_) {
    first_ = state.utime;
    next_look_ = kFirstLook;
  }
  if (look_.valid() && state.utime >= due_) take(look_.get());
  const double shown = seconds_between(*first_, state.utime);
  if (look_.valid() || shown < next_look_) return;
  next_look_ = kWider * shown;
  due_ = utime_after(state.utime, kThinking);
  try {
    look_ = std::async(std::launch::async, [seen = until(state.utime)]() mutable {
      const Seen own = std::move(seen);  // gone with the look, not with its answer
      return look(own);
    });
  } catch (const std::system_error&) {  // no thread to be had: the next look will do
  }
}

/// What every channel has told by then, however late or early it is.
LiveSensorCheck::Seen LiveSensorCheck::until(Utime now) const {
  const Utime end = utime_after(now, -kSkew), begin = std::max(utime_after(end, -kKept), first_.value_or(now));
  const auto within = [&](const auto& sample) { return sample.utime >= begin && sample.utime <= end; };
  Seen seen;
  Recording& recording = seen.sensors;
  recording.name = "trial";
  recording.pose_capture.reserve(states_.size());
  recording.ahrs.reserve(rates_.size());
  recording.dvl.reserve(velocities_.size());
  for (const consistency::MotionAt& at : states_) {
    if (!within(at)) continue;
    recording.pose_capture.push_back({.utime = at.utime, .p_WB = at.p_WB, .q_WB = at.q_WB, .valid = at.valid});
  }
  for (const Sample& sample : rates_) {
    if (within(sample)) recording.ahrs.push_back({.utime = sample.utime, .w_WB_B = sample.x, .has_rates = true});
  }
  const Eigen::Matrix3d turned = skew(corrections_.dvl.lever) + corrections_.dvl.coupling;
  for (const Sample& sample : velocities_) {
    if (!within(sample)) continue;
    const auto after = std::ranges::upper_bound(rates_, sample.utime, {}, &Sample::utime);
    const Eigen::Vector3d w = after == rates_.begin() ? Eigen::Vector3d{Eigen::Vector3d::Zero()} : std::prev(after)->x;
    recording.dvl.push_back({.utime = sample.utime, .v_WB_B = sample.x + turned * w});
  }
  recording.one_estimate = recording.dvl.empty();
  if (flow_) {
    seen.pictures = flow_->seen(states_, begin, end);
    seen.site = flow_->site();
  }
  return seen;
}

/// STATE stands for the motion capture; what the estimator makes of all sensors is none of them, and is not named.
LiveSensorCheck::Found LiveSensorCheck::look(const Seen& seen) {
  auto checked = consistency::check_consistency(std::span(&seen.sensors, 1));
  if (!seen.pictures.dvl.empty()) {
    consistency::PairResult flow = consistency::compare_flow(std::span(&seen.pictures, 1), *seen.site);
    std::ranges::move(flow.findings, std::back_inserter(checked.findings));
    checked.pairs.emplace("optical_flow", std::move(flow));
  }
  Found found;
  for (const auto& [signal, pair] : checked.pairs) {
    if (pair.checked) found.judged.push_back(signal);
  }
  const auto turn = [&](const std::string& signal) -> Eigen::Matrix3d {
    const consistency::PairResult& pair = checked.pairs.at(signal);
    return pair.checked ? pair.faults.front().rotation : Eigen::Matrix3d::Identity();
  };
  found.turns = {.gyro = turn("gyro"), .dvl = turn("dvl")};
  for (const EffectFound& fault : sensor_faults(checked.findings)) {
    for (const NamedValue& number : fault.parameters) {
      const std::string signal = signal_of(number);
      const bool told = std::ranges::any_of(
          found.faults, [&](const EffectEvidence& one) { return one.name == fault.name && one.variant == signal; });
      if (told || std::ranges::find(found.judged, group_of(signal)) == found.judged.end()) continue;
      found.faults.push_back(
          {.name = fault.name, .log_odds = fault.log_odds, .variant = signal, .numbers = numbers_of(fault, number)});
    }
  }
  return found;
}

void LiveSensorCheck::take(Found found) {
  const auto judged = [&](const std::string& signal) {
    return std::ranges::find(found.judged, signal) != found.judged.end();
  };
  std::erase_if(faults_, [&](const EffectEvidence& one) { return judged(group_of(one.variant)); });
  velocity_judged_ = velocity_judged_ || judged("optical_flow");
  if (judged("gyro")) turns_.gyro = found.turns.gyro;
  if (judged("dvl")) turns_.dvl = found.turns.dvl;
  faults_.insert(faults_.end(), found.faults.begin(), found.faults.end());
  std::ranges::stable_sort(faults_, std::greater{}, &EffectEvidence::log_odds);
}

void LiveSensorCheck::finish() {
  if (look_.valid()) take(look_.get());
  if (!states_.empty()) take(look(until(utime_after(states_.back().utime, kSkew))));
}

void LiveSensorCheck::reset() {
  if (look_.valid()) (void)look_.get();
  if (flow_) flow_->clear();
  *this = LiveSensorCheck{std::move(corrections_), std::move(flow_)};
}

}  // namespace fathom::diagnosis

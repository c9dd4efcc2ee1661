// What the supervisor does when it is told to: arm, abort, hold, steer, go on, and fly a segment by its name.
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/excitation/segments.hpp"
#include "common/excitation/supervisor.hpp"

namespace fathom::excitation {
namespace {

constexpr double kLongestFlight = 600.0;  // s: nobody attends for longer

}  // namespace

void Supervisor::hear(const EffectRanking& ranking) {
  const bool found = ranking.verdict == "effect" && !ranking.candidates.empty();
  suspect_ = found ? ranking.candidates.front().name : "";
  proposal_.reset();
  if (ranking.segment.empty() || ranking.candidates.empty()) return;
  proposal_ = {.segment = ranking.segment,
               .duration = std::min(ranking.duration, kLongestFlight),
               .purpose = "to tell " + ranking.candidates.front().name + " from " + ranking.against};
}

// An abort needs no permission. Everything else must come from somebody who knows the token, once, and now.
void Supervisor::hear(const Operator& order) {
  if (order.abort) {
    stop(Phase::kAborted, "aborted by the operator", Then::kZero);
    return;
  }
  if (order.token != token_ || order.sequence <= last_sequence_) return;
  if (!has_state_ || std::abs(seconds_between(order.utime, state_.utime)) > settings_.order_age) return;
  last_sequence_ = order.sequence;
  if (order.order == "fly") {
    fly(order);
  } else if (order.enable && !armed_) {
    if (arm()) enter(0);
  } else if (armed_) {
    this->order(order);
  }
  if (armed_ && order.enable) armed_by_ = order.sequence;  // the thrusters may have lost what armed it before
}

void Supervisor::order(const Operator& order) {
  if (order.order == "hold") {
    stay("the operator wants it to stay");
  } else if (order.order == "manual") {
    flight_.reset();
    phase_ = Phase::kManual;
    manual_ = order.tau;
    reason_ = "the operator steers";
  } else if (order.order == "identify") {
    if (phase_ == Phase::kHold || phase_ == Phase::kManual || phase_ == Phase::kDone)
      enter(phase_ == Phase::kDone ? 0 : mode_);
  } else if (order.order == "skip") {
    if (flight_) {
      land("skipped by the operator");
    } else {
      finish_mode(false, "skipped by the operator");
    }
  } else if (order.order == "retry") {
    if (flight_) {
      take_off();
    } else {
      enter(mode_);
    }
  }
}

bool Supervisor::arm() {
  std::string why;
  if (!state_.valid) why = "the state is not valid";
  if (why.empty()) why = fence_.outside(state_, 0.0);
  if (const auto trouble = needs_.trouble(); why.empty() && trouble)
    why = trouble->process + " " + trouble->what + "; " + trouble->remedy;
  if (why.empty()) why = grave_;
  if (!why.empty()) {
    reason_ = "not armed: " + why;
    return false;
  }
  after_.end();
  armed_ = true;
  armed_at_ = state_.utime;
  lost_since_ = 0;
  turned_ = 0.0;
  FenceSettings settings = settings_.fence;
  for (Eigen::Index i = 0; i < 3; ++i) {
    // Water that goes on for longer is no room for a trial: in the open a velocity log loses the bottom.
    settings.low[i] = std::max(settings.low[i], state_.p_WB[i] - settings_.open_range);
    settings.high[i] = std::min(settings.high[i], state_.p_WB[i] + settings_.open_range);
  }
  fence_ = Fence{settings};
  middle_ = fence_.middle();
  visits_.clear();
  frozen_.clear();
  hold_.reset();
  flights_ = 0;
  closing_.clear();
  refused_.clear();
  return true;
}

// A vehicle that is not armed arms for the flight alone; one that is goes on afterwards with what it did.
void Supervisor::fly(const Operator& order) {
  const bool proposed = order.segment.empty();
  if (!armed_ && !order.enable) return;
  if (proposed && !proposal_) {
    refuse("nothing to fly: no segment is proposed");
    return;
  }
  const std::string& name = proposed ? proposal_->segment : order.segment;
  std::optional<Segment> segment = segment_named(name, vehicle_, settings_.largest);
  if (!segment) {
    refuse("no segment '" + name + "' for this vehicle; fathom plan names them");
    return;
  }
  const bool alone = !armed_;
  if (alone && !arm()) return;
  const double once = segment->duration;
  double duration = order.duration > 0.0 ? order.duration : once;
  if (proposed && !(order.duration > 0.0)) duration = proposal_->duration;
  const Phase before = flight_ ? flight_->before : phase_;
  flight_ = {.segment = std::move(*segment),
             .duration = std::min(duration, kLongestFlight),
             .purpose = proposed ? proposal_->purpose : "as the operator wants",
             .before = alone ? Phase::kDone : before};
  take_off();
}

/// What cannot be flown changes nothing, but is said.
void Supervisor::refuse(const std::string& why) {
  if (!armed_) {
    reason_ = "not armed: " + why;
  } else {
    refused_ = kNotFlown + why;
  }
}

void Supervisor::stay(const std::string& why) {
  flight_.reset();
  phase_ = Phase::kHold;
  place_ = {state_.p_WB, turned_};
  reason_ = why;
}

// As it was rehearsed: from the middle of the room, bow to the north or to the south.
void Supervisor::take_off() {
  refused_.clear();
  phase_ = Phase::kApproach;
  phase_since_ = now();
  place_ = {middle_, turned_towards(0.0)};
  reason_ = "goes to where '" + flight_->segment.name + "' begins";
}

void Supervisor::land(const std::string& how) {
  const Flight flown = std::move(*flight_);
  flight_.reset();
  const std::string told = "'" + flown.segment.name + "' " + how;
  if (flown.before == Phase::kApproach || flown.before == Phase::kExcite) {
    begin();
  } else if (flown.before == Phase::kDone) {
    finish(closing_.empty() ? told : closing_ + "; " + told);
  } else {
    stay(told);
  }
}

}  // namespace fathom::excitation

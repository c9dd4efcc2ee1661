// What the supervisor does when it is told to: arm, abort, hold, steer, go on, and fly a segment by its name.
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/excitation/segments.hpp"
#include "common/excitation/supervisor.hpp"
#include "common/orders/words.hpp"

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

void Supervisor::hear(const Answer& answer) {
  if (!answer.gate || !answer.authentic) return;
  const bool of_now = !has_state_ || std::abs(seconds_between(answer.utime, state_.utime)) <= settings_.order_age;
  if (of_now) check_.begin(answer.challenge, answer.accepted);
}

// An abort needs no permission. Everything else must come from somebody who has the key, once, and now.
Answer Supervisor::hear(const Operator& order) {
  Answer answer{.sequence = order.sequence};
  bool accepted = false;
  if (order.abort) {
    if (has_state_) check_.abort(state_.utime);
    stop(Phase::kAborted, "aborted by the operator", Then::kZero);
    answer.done = true;
    answer.text = reason_;
  } else if (check_.again(order)) {
    accepted = true;
    answer = answered_;
    if (answered_.armed && !armed_) {  // what was done then has ended since
      answer.done = false;
      answer.text = "ended since: " + reason_;
    }
  } else {
    answer.text = has_state_ ? std::string{check_.objection(order, state_.utime)} : "no STATE has come";
    accepted = answer.text.empty();
    if (accepted) {
      check_.accept(order);
      sign_of_life_ = state_.utime;
      answer.text = obey(order);
      answer.done = answer.text.empty();
      if (answer.done)
        answer.text = order.order == orders::kPreflight ? place() : std::string{name(phase_)} + ": " + doing();
    }
  }
  answer.utime = has_state_ ? state_.utime : order.utime;
  answer.challenge = check_.challenge();
  answer.accepted = check_.accepted();
  answer.armed = armed_;
  if (accepted) answered_ = answer;
  return answer;
}

/// Empty when it is done, else why not.
std::string Supervisor::obey(const Operator& order) {
  if (order.order == orders::kPreflight) {
    const std::string why = against_the_place();
    return why.empty() || !state_.valid ? why : why + ": " + place();
  }
  if (order.order == orders::kOther) return "another controller is armed; this supervisor stays out of it";
  std::string why;
  const bool flies = order.order == "fly";
  if (order.enable && settings_.wants_operator && !(order.attends > 0.0)) {
    why = "not armed: this vehicle's operator must stay (operator_lost: required); fathom arm --attend";
    if (!armed_) reason_ = why;
    return why;
  }
  const bool was_armed = armed_;
  if (flies) {
    fly(order);
    if (!armed_) why = reason_;
    if (armed_ && !refused_.empty()) why = refused_;
  } else if (order.enable && !armed_) {
    if (!arm()) {
      why = reason_;
    } else if (order.order == "manual" || order.order == "hold") {
      why = this->order(order);
    } else {
      enter(0);
    }
  } else if (armed_) {
    why = this->order(order);
  } else if (!order.order.empty()) {
    why = "not armed: " + (reason_.starts_with("not armed") ? std::string{"fathom arm first"} : reason_);
  }
  if (armed_ && order.enable) {  // the thrusters may have lost what armed it before
    armed_by_ = order.sequence;
    armed_challenge_ = order.challenge;
    if (!was_armed || order.attends > 0.0) attends_ = order.attends;
  }
  operator_is_lost_ = operator_is_lost_ && !armed_;
  return why;
}

/// By the time of STATE: a replay misses the operator when the trial did.
void Supervisor::miss_operator() {
  const double silent = seconds_between(sign_of_life_, state_.utime);
  if (!(attends_ > 0.0) || silent <= attends_ || operator_is_lost_) return;
  operator_is_lost_ = true;
  const std::string why = "the operator is lost: no sign of life for " + std::to_string(std::lround(silent)) + " s";
  if (settings_.holds_without_operator) {
    stay(why + "; it stays");
  } else {
    stop(Phase::kAborted, why);
  }
}

std::string Supervisor::order(const Operator& order) {
  if (order.order.empty()) return {};
  if (order.order == "hold") {
    stay("the operator wants it to stay");
  } else if (order.order == "manual") {
    flight_.reset();
    phase_ = Phase::kManual;
    manual_ = order.tau;
    manual_at_ = state_.utime;
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
  } else {
    return "no order '" + order.order + "'; known: hold, identify, manual, skip, retry, fly";
  }
  return {};
}

// By the site's bounds: those around the place of the last arming were that trial's alone.
std::string Supervisor::against_the_place() const {
  if (!state_.valid) return "the state is not valid";
  Fence site{settings_.fence};
  site.begin(state_.p_WB, vehicle_.dof[2]);
  return site.outside(state_, 0.0);
}

std::string Supervisor::place() const {
  const Fence site{settings_.fence};
  const std::string floats = !site.floats(state_.p_WB) ? ""
                             : vehicle_.dof[2]         ? "floats, goes down first: "
                                                       : "floats: ";
  return floats + site.place(state_, settings_.surface);
}

bool Supervisor::arm() {
  std::string why = against_the_place();
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
  fence_.begin(state_.p_WB, vehicle_.dof[2]);
  descending_ = 0.0;
  operator_is_lost_ = false;
  middle_ = fence_.middle();
  if (!vehicle_.dof[2]) middle_.z() = state_.p_WB.z();  // at its own depth
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
  if (!armed_ && !order.enable) {
    refuse("fathom arm first");
    return;
  }
  if (proposed && !proposal_) {
    refuse("nothing to fly: no segment is proposed");
    return;
  }
  const std::string& name = proposed ? proposal_->segment : order.segment;
  std::optional<model::Manoeuvre> preset = preset_named(name);
  std::optional<Segment> segment = preset ? segment_of(*preset, name, vehicle_, settings_.largest)
                                          : segment_named(name, vehicle_, settings_.largest);
  if (!segment) {
    refuse("no segment '" + name + "' for this vehicle; fathom plan names them");
    return;
  }
  const bool alone = !armed_;
  if (alone && !arm()) return;
  refused_.clear();
  const double once = segment->duration;
  double duration = order.duration > 0.0 ? order.duration : once;
  if (proposed && !(order.duration > 0.0)) duration = proposal_->duration;
  const Phase before = flight_ ? flight_->before : phase_;
  flight_ = {.segment = std::move(*segment),
             .duration = std::min(duration, kLongestFlight),
             .purpose = proposed ? proposal_->purpose : "as the operator wants",
             .before = alone ? Phase::kDone : before};
  if (preset) {
    preset->duration = flight_->duration;
    flight_->pilot.emplace(*preset);
    flight_->one_turn = preset->kind == model::ManoeuvreKind::kCircle && !(order.duration > 0.0);
  }
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

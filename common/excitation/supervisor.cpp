#include "common/excitation/supervisor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/error.hpp"

namespace fathom::excitation {
namespace {

constexpr double kNear = 0.12;       // m from the place where a mode begins
constexpr double kNearTurn = 0.12;   // rad
constexpr double kSlow = 0.05;       // m/s, rad/s
constexpr double kSayStopped = 1.0;  // s of commanding zero after a stop, should a message be lost

double heading_of(const StateEstimate& state) {
  const Eigen::Vector3d ahead = state.q_WB * Eigen::Vector3d::UnitX();
  return std::atan2(ahead.y(), ahead.x());
}

std::string words(const Needs::Trouble& trouble) {
  return trouble.process + " " + trouble.what + "; " + trouble.remedy;
}

}  // namespace

const char* name(Phase phase) {
  switch (phase) {
    case Phase::kDisarmed:
      return "disarmed";
    case Phase::kApproach:
      return "approach";
    case Phase::kExcite:
      return "excite";
    case Phase::kHold:
      return "hold";
    case Phase::kManual:
      return "manual";
    case Phase::kDone:
      return "done";
    case Phase::kAborted:
      return "aborted";
    default:
      return "lost";
  }
}

Supervisor::Supervisor(const SupervisorSettings& settings, const model::Vehicle& vehicle)
    : settings_{settings},
      vehicle_{vehicle},
      check_{settings.order_age},
      fence_{settings.fence},
      hold_{settings.hold, settings.largest},
      designer_{settings.design, vehicle, settings.largest, settings.seed},
      signals_(6),
      needs_{settings.needs, settings.silence},
      after_{settings.after_abort, settings.surface} {
  if (settings_.schedule.empty()) throw InputError("supervisor: the schedule is empty");
  for (const Mode& mode : settings_.schedule) {
    if (mode.axis >= 0 && !vehicle_.dof[static_cast<std::size_t>(mode.axis)]) {
      throw InputError("supervisor: vehicle '" + vehicle_.name + "' cannot move in mode " + mode.name);
    }
  }
}

void Supervisor::reset() {
  const bool interrupted = armed_;
  const std::int64_t commands = commands_;  // the thrusters remember
  *this = Supervisor{SupervisorSettings{settings_}, model::Vehicle{vehicle_}};
  commands_ = commands;
  if (interrupted) reason_ = "the time of STATE went back: is the attitude sensor's clock right? then arm again";
}

void Supervisor::hear(const ModelEstimate& model) {
  model_ = model;
  model_is_new_ = true;
  since_model_ = 0.0;
}

void Supervisor::hear(const Health& health) { needs_.hear(health); }

void Supervisor::hear(const VehicleCondition& vehicle) {
  const auto grave = std::find_if(vehicle.lines.begin(), vehicle.lines.end(),
                                  [](const ConditionLine& line) { return line.grave && !line.ok; });
  grave_ = grave == vehicle.lines.end() ? "" : grave->text;
  taken_ = vehicle.armed == 0;
  if (armed_ && !grave_.empty()) stop(Phase::kAborted, grave_);
  // Who has disarmed the vehicle itself may have it in the hands: it does not move again when it is armed there.
  if (taken_ && after_.active()) {
    after_.end();
    reason_ = ended_ + "; zero thrust: the vehicle was disarmed";
    armed_at_ = state_.utime;
  }
}

// Where no STATE comes there is no step either; somebody must say that the trial is over.
void Supervisor::watch(double now) {
  constexpr double kAway = 1.0;  // s; it was this process that stood still
  needs_.watch(now);
  const double passed = watched_ ? now - *watched_ : 0.0;
  watched_ = now;
  if (state_.utime != state_seen_ || !armed_) {
    state_came_ = now;
  } else if (passed > kAway) {
    state_came_ += passed;
  }
  state_seen_ = state_.utime;
  if (now - state_came_ <= settings_.patience) return;
  if (const auto trouble = needs_.trouble()) {
    stop(Phase::kAborted, words(*trouble));
  } else {
    stop(Phase::kLost, "no STATE came for " + std::to_string(std::lround(now - state_came_)) +
                           " s: is the attitude sensor well? then arm again");
  }
}

// The operator's zero is above everything; an end that nobody ordered is followed by what the vehicle file says.
void Supervisor::stop(Phase phase, const std::string& reason, Then then) {
  const bool flies = after_.active();
  if (then == Then::kZero) after_.end();
  if (phase_ == Phase::kAborted && !armed_ && !(flies && then == Then::kZero)) return;
  if (armed_ && then == Then::kAsTheVehicleFileSays && !taken_) after_.begin(state_);
  armed_ = false;
  phase_ = phase;
  reason_ = ended_ = reason;
  if (after_.active()) reason_ += "; then: " + after_.text();
  armed_at_ = state_.utime;
  segment_.reset();
  flight_.reset();
}

bool Supervisor::arrived() const {
  return (place_.p_WB - state_.p_WB).norm() < kNear && std::abs(place_.turned - turned_) < kNearTurn &&
         state_.nu.head<3>().norm() < kSlow && std::abs(state_.nu[5]) < kSlow;
}

void Supervisor::say(const Vector6d& tau, const Vector6d& probe, bool bent) {
  output_.command = WrenchCommand{.utime = state_.utime,
                                  .tau = tau,
                                  .life = settings_.life,
                                  .armed_by = armed_by_,
                                  .challenge = armed_challenge_,
                                  .sequence = ++commands_};
  const bool active = phase_ == Phase::kExcite;
  Excitation said{.utime = state_.utime, .active = active, .reason = doing(), .probe = probe};
  if (!refused_.empty()) said.reason += "; " + refused_;
  said.mode = armed_ ? mode().name : "";
  said.phase = name(phase_);
  said.signal = !active ? "" : (settings_.optimal ? (segment_ ? segment_->name : "") : "algorithm 1");
  said.elapsed = armed_ ? dwell_ : 0.0;
  said.duration = settings_.most_dwell;
  said.metric = verdict_.metric;
  said.threshold = armed_ ? mode().threshold : 0.0;
  said.missing = verdict_.words();
  said.bent = bent;
  said.frozen = frozen_;
  if (flight_) {
    said.mode = kSegmentMode;
    said.signal = active ? flight_->segment.name : "";
    said.elapsed = active ? now() - phase_since_ : 0.0;
    said.duration = flight_->duration;
    said.metric = -1.0;
    said.threshold = 0.0;
    said.missing.clear();
    said.frozen.clear();
  }
  output_.excitation = said;
}

const Supervisor::Output& Supervisor::step(const StateEstimate& state) {
  output_.command.reset();
  output_.excitation.reset();
  const bool finite = state.p_WB.allFinite() && state.nu.allFinite() && state.q_WB.coeffs().allFinite();
  if (!finite || (has_state_ && state.utime <= state_.utime)) return output_;
  const double heading = heading_of(state);
  const double gap = has_state_ ? seconds_between(state_.utime, state.utime) : 0.0;
  if (has_state_) turned_ += wrap_angle(heading - last_heading_);
  last_heading_ = heading;
  state_ = state;
  has_state_ = true;
  const double since = seconds_between(last_command_, state.utime);
  if (last_command_ != 0 && since + kRounding < 1.0 / settings_.rate) return output_;
  const double dt = last_command_ == 0 ? 0.0 : std::min(since, 2.0 / settings_.rate);
  last_command_ = state.utime;

  if (!armed_ && after_.active()) {
    const Vector6d tau = after_.step(state, hold_, dt);
    reason_ = ended_ + "; then: " + after_.text();
    if (!after_.active()) armed_at_ = state.utime;  // zeros are said for a while
    say(tau.cwiseMax(-settings_.largest).cwiseMin(settings_.largest), Vector6d::Zero(), false);
    return output_;
  }
  if (!armed_) {
    say(Vector6d::Zero(), Vector6d::Zero(), false);
    const bool stopping = phase_ == Phase::kAborted || phase_ == Phase::kLost;
    if (!stopping || now() > kSayStopped) output_.command.reset();
    return output_;
  }
  miss_operator();
  const auto trouble = needs_.trouble();
  const bool usable = state.valid && !trouble;
  if (!usable && lost_since_ == 0) lost_since_ = state.utime;
  const bool too_long = !usable && seconds_between(lost_since_, state.utime) > settings_.patience;
  if (too_long && trouble) {
    stop(Phase::kAborted, words(*trouble));
  } else if (const std::string why = state.valid ? fence_.outside(state, turned_) : ""; !why.empty()) {
    stop(Phase::kAborted, "left the envelope: " + why + (trouble ? ", without thrust since " + words(*trouble) : ""));
  } else if (too_long || gap > settings_.patience) {
    stop(Phase::kLost, "the state was lost; arm again");
  } else if (usable && settings_.model_patience > 0.0 && phase_ == Phase::kExcite &&
             since_model_ > settings_.model_patience) {
    const std::string silent = needs_.behind();
    stop(Phase::kAborted, (silent.empty() ? "the identifier" : silent) + " is silent: no MODEL came");
  }
  since_model_ = state.valid && phase_ == Phase::kExcite ? since_model_ + dt : 0.0;
  if (!armed_ || !usable) {  // without thrust until it is, not forever
    say(Vector6d::Zero(), Vector6d::Zero(), false);
    if (armed_) output_.excitation->phase = name(Phase::kLost);
    if (armed_ && trouble) output_.excitation->reason = "no thrust: " + trouble->process + " " + trouble->what;
    return output_;
  }
  if (lost_since_ != 0) {  // back again: where a mode begins, not where it was cut
    lost_since_ = 0;
    resume();
  }
  if (descend(dt)) return output_;

  const bool anywhere = settings_.optimal && !flight_ && fence_.holds(state.p_WB, state.q_WB * state.nu.head<3>());
  if (phase_ == Phase::kApproach && (anywhere || arrived() || now() - phase_since_ > settings_.approach_time)) {
    phase_ = Phase::kExcite;
    phase_since_ = now();
    if (flight_ && flight_->pilot) {  // from the heading at which it begins
      model::Manoeuvre manoeuvre = flight_->pilot->manoeuvre();
      manoeuvre.heading = last_heading_;
      flight_->pilot.emplace(manoeuvre);
      flight_->turned = turned_;
    }
    reason_ = flight_ ? "flies '" + flight_->segment.name + "' " + flight_->purpose : "settles mode " + mode().name;
  }
  std::array<bool, 6> held{};
  for (std::size_t axis = 0; axis < 6; ++axis) held[axis] = vehicle_.dof[axis];
  Vector6d share = Vector6d::Zero();
  if (phase_ == Phase::kExcite && flight_) {
    const bool round = flight_->one_turn && std::abs(turned_ - flight_->turned) >= 2.0 * std::numbers::pi;
    if (round || now() - phase_since_ >= flight_->duration - kRounding) land("is flown");
  } else if (phase_ == Phase::kExcite) {
    dwell_ += dt;
    judge(now());
  }
  if (phase_ == Phase::kExcite) {
    for (int axis = 0; axis < 6; ++axis) {
      if (excites(axis)) held[static_cast<std::size_t>(axis)] = false;
    }
    share = probe(dt);
  } else if (phase_ == Phase::kManual && seconds_between(manual_at_, state.utime) > settings_.manual_life) {
    stay("who steers has let go: it stays");  // the dead man
  } else if (phase_ == Phase::kManual) {
    held.fill(false);
    share = manual_;
  } else if (phase_ == Phase::kDone && now() - phase_since_ > settings_.closing_time) {
    stop(Phase::kDone, reason_);
    say(Vector6d::Zero(), Vector6d::Zero(), false);
    return output_;
  }
  const Vector6d holding = hold_.step(state, turned_, place_, held, dt);
  const Fence::Bent allowed =
      fence_.bend(holding + share, state, turned_, settings_.hold.mass, settings_.hold.inertia, settings_.largest);
  if (phase_ == Phase::kExcite) turn(allowed.turn);
  // What holding asks beyond the limit is cut too; the log shows what was commanded, THRUSTERS what was applied.
  say(allowed.tau, phase_ == Phase::kExcite ? Vector6d(allowed.tau - holding) : Vector6d(Vector6d::Zero()),
      allowed.bent);
  return output_;
}

}  // namespace fathom::excitation

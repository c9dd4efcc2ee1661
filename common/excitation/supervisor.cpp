#include "common/excitation/supervisor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/error.hpp"
#include "common/excitation/segments.hpp"

namespace fathom::excitation {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kNear = 0.12;       // m from the place where a mode begins
constexpr double kNearTurn = 0.12;   // rad
constexpr double kSlow = 0.05;       // m/s, rad/s
constexpr double kSayStopped = 1.0;  // s of commanding zero after a stop, should a message be lost
constexpr double kRounding = 1e-4;   // s: stamps are whole microseconds

double heading_of(const StateEstimate& state) {
  const Eigen::Vector3d ahead = state.q_WB * Eigen::Vector3d::UnitX();
  return std::atan2(ahead.y(), ahead.x());
}

std::string words(const Needs::Trouble& trouble) {
  return trouble.process + " " + trouble.what + "; " + trouble.remedy;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : "; ") + part;
  return all;
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

// A mode begins in the middle of the room, with the axis that it excites along the room's longer side.
Place Supervisor::place_for(const Mode& mode) const {
  const Eigen::Vector3d room = fence_.settings().high - fence_.settings().low;
  const double longer = room.x() >= room.y() ? 0.0 : 0.5 * kHalfTurn;
  return {middle_, turned_towards(mode.axis == 1 ? longer + 0.5 * kHalfTurn : longer)};
}

// Either way round serves; the nearer one, but not further than half a turn of the tether.
double Supervisor::turned_towards(double heading) const {
  const double start = last_heading_ - turned_;
  double target = heading - start;
  target += kHalfTurn * std::round((turned_ - target) / kHalfTurn);
  while (target > kHalfTurn) target -= kHalfTurn;
  while (target < -kHalfTurn) target += kHalfTurn;
  return target;
}

void Supervisor::enter(std::size_t mode) {
  mode_ = mode;
  attempt_ = 0;
  mode_since_ = now();
  dwell_ = 0.0;
  verdict_ = {};
  flight_.reset();
  if (this->mode().axis < 0) frozen_.clear();  // all are learnt again to the end
  begin();
}

void Supervisor::begin() {
  phase_ = Phase::kApproach;
  phase_since_ = now();
  place_ = place_for(mode());
  segment_.reset();
  model_is_new_ = false;
  reason_ = "goes to where mode " + mode().name + " begins";
  const auto steps = [&](double time) { return std::max(1, static_cast<int>(std::lround(time * settings_.rate))); };
  for (std::size_t axis = 0; axis < 6; ++axis) {
    signals_[axis].reset();
    if (!excites(static_cast<int>(axis))) continue;
    const std::uint64_t seed =
        settings_.seed * 1'000'003U + mode_ * 101U + axis * 11U + static_cast<std::uint64_t>(attempt_);
    signals_[axis].emplace(PaperSignalSettings{.largest = settings_.largest[static_cast<Eigen::Index>(axis)],
                                               .low_share = settings_.low_share,
                                               .highest_frequency = settings_.highest_frequency,
                                               .submode_steps = steps(settings_.submode_time),
                                               .interval_steps = steps(settings_.interval_time),
                                               .random_amplitude = settings_.random_amplitude},
                           seed);
  }
}

bool Supervisor::excites(int axis) const {
  if (!vehicle_.dof[static_cast<std::size_t>(axis)] || settings_.largest[axis] <= 0.0) return false;
  return flight_ ? flight_->segment.moves(axis) : mode().axis < 0 || mode().axis == axis;
}

void Supervisor::finish_mode(bool left, const std::string& missing) {
  visits_.push_back({.mode = mode().name, .begun = mode_since_, .ended = now(), .left = left, .missing = missing});
  if (left && mode().axis >= 0) {
    for (std::string& name : parameters_of(mode(), vehicle_)) frozen_.push_back(std::move(name));
  }
  if (mode_ + 1 < settings_.schedule.size()) {
    enter(mode_ + 1);
    return;
  }
  std::string open;
  for (const Visit& visit : visits_) {
    if (!visit.left) open += (open.empty() ? "" : "; ") + visit.mode + ": " + visit.missing;
  }
  closing_ = open.empty() ? "all modes are done" : "done, but not settled: " + open;
  finish(closing_);
}

// At the end it flies what it may without being asked.
void Supervisor::finish(const std::string& reason) {
  phase_ = Phase::kDone;
  phase_since_ = now();
  place_ = {state_.p_WB, turned_};
  reason_ = reason;
  if (!proposal_ || flights_ >= settings_.flights) return;
  std::optional<Segment> segment = segment_named(proposal_->segment, vehicle_, settings_.largest);
  if (!segment) return;
  ++flights_;
  flight_ = {std::move(*segment), proposal_->duration, proposal_->purpose, Phase::kDone};
  take_off();
}

void Supervisor::judge(double now) {
  if (model_ && model_is_new_) {
    model_is_new_ = false;
    verdict_ = may_leave(mode(), *model_, vehicle_, settings_.leaving);
    const bool adopted = std::find(model_->effects.begin(), model_->effects.end(), suspect_) != model_->effects.end();
    if (!verdict_.missing.empty() && !suspect_.empty() && !adopted)
      verdict_.missing.push_back("suspected: " + suspect_);
    if (verdict_.missing.empty() && dwell_ >= settings_.least_dwell) {
      finish_mode(true, "");
      return;
    }
  }
  if (now - phase_since_ < settings_.most_dwell) return;
  // Variances fall as one over time: who lacks nothing else, and will have enough within one more attempt, is given it.
  const double share = verdict_.metric / mode().threshold;
  const bool nearly = attempt_ == settings_.retries && verdict_.missing.size() == 1 && !verdict_.certain &&
                      share > 0.0 && (share - 1.0) * (attempt_ + 1) <= 1.0;
  if (attempt_ < settings_.retries || nearly) {
    ++attempt_;
    begin();
  } else {
    finish_mode(false, verdict_.missing.empty() ? "no MODEL came" : joined(verdict_.missing));
  }
}

Vector6d Supervisor::probe(double dt) {
  Vector6d tau = Vector6d::Zero();
  if (flight_ && flight_->pilot) {
    const auto [ahead, turning] = flight_->pilot->demand(now() - phase_since_, last_heading_);
    tau[0] = ahead * settings_.largest[0];
    tau[5] = turning * settings_.largest[5];
    return tau;
  }
  if (flight_) {
    const Segment& segment = flight_->segment;
    return segment.at(std::fmod(now() - phase_since_, segment.duration)).cwiseProduct(settings_.largest);
  }
  if (settings_.optimal) {
    if (!segment_ || now() - segment_since_ >= segment_->duration - kRounding) {
      segment_ = designer_.next(state_, turned_, model_.value_or(ModelEstimate{}), fence_, hold_.trim());
      segment_since_ = now();
    }
    return segment_->at(now() - segment_since_).cwiseProduct(settings_.largest);
  }
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (signals_[axis]) tau[static_cast<Eigen::Index>(axis)] = signals_[axis]->step(dt);
  }
  return tau;
}

void Supervisor::turn(const std::array<bool, 6>& axes) {
  if (settings_.optimal || flight_) return;  // what is designed fits, or is bent for the rest of a segment
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (axes[axis] && signals_[axis]) signals_[axis]->turn();
  }
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
  Excitation said{.utime = state_.utime, .active = active, .reason = reason_, .probe = probe};
  if (!refused_.empty()) said.reason += "; " + refused_;
  said.mode = armed_ ? mode().name : "";
  said.phase = name(phase_);
  said.signal = !active ? "" : (settings_.optimal ? (segment_ ? segment_->name : "") : "algorithm 1");
  said.elapsed = armed_ ? dwell_ : 0.0;
  said.duration = settings_.most_dwell;
  said.metric = verdict_.metric;
  said.threshold = armed_ ? mode().threshold : 0.0;
  said.missing = joined(verdict_.missing);
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
    if (phase_ == Phase::kExcite || phase_ == Phase::kApproach) {
      if (flight_) {
        take_off();
      } else {
        begin();
      }
    }
  }

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
    const bool round = flight_->one_turn && std::abs(turned_ - flight_->turned) >= 2.0 * kHalfTurn;
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

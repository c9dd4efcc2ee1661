// The schedule: where a mode begins, what excites it, and when it is left, tried again or given up.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/excitation/segments.hpp"
#include "common/excitation/supervisor.hpp"

namespace fathom::excitation {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

}  // namespace

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

void Supervisor::resume() {
  if (phase_ != Phase::kExcite && phase_ != Phase::kApproach) return;
  if (flight_) {
    take_off();
  } else {
    begin();
  }
}

// Near the surface propellers draw air and people are: nothing but downward thrust until the vehicle is in its room. A
// schedule and a flight go there by themselves; who steers does it with his own push, and what shall stay floats.
bool Supervisor::descend(double dt) {
  if (!fence_.afloat() || phase_ == Phase::kDone) return false;
  fence_.follow(state_.p_WB);
  if (!fence_.afloat()) {
    resume();
    if (phase_ == Phase::kHold) place_ = {state_.p_WB, turned_};
    return false;
  }
  if (phase_ == Phase::kManual && seconds_between(manual_at_, state_.utime) > settings_.manual_life)
    stay("who steers has let go: it stays");
  Vector6d tau = Vector6d::Zero();
  bool bent = false;
  if (phase_ == Phase::kManual) {
    const Eigen::Matrix3d R_WB = state_.q_WB.toRotationMatrix();
    const double down = std::max(0.0, R_WB.row(2).dot(manual_.head<3>()));
    tau.head<3>() = down * R_WB.row(2).transpose();
  } else if (phase_ != Phase::kHold) {
    descending_ += dt;
    if (descending_ > settings_.approach_time) {
      stop(Phase::kAborted, "did not come down from the surface in " +
                                std::to_string(std::lround(settings_.approach_time)) +
                                " s: is it too light, or is there air under its hull?");
    } else {
      const FenceSettings& room = fence_.settings();
      const Place below{{state_.p_WB.x(), state_.p_WB.y(), room.low.z() + room.band}, turned_};
      tau[2] = hold_.step(state_, turned_, below, {false, false, true, false, false, false}, dt)[2];
      const Fence::Bent allowed =
          fence_.bend(tau, state_, turned_, settings_.hold.mass, settings_.hold.inertia, settings_.largest);
      tau = allowed.tau;
      bent = allowed.bent;
    }
  }
  say(tau.cwiseMax(-settings_.largest).cwiseMin(settings_.largest), Vector6d::Zero(), bent);
  return true;
}

std::string Supervisor::doing() const {
  if (!armed_ || !fence_.afloat() || phase_ == Phase::kDone) return reason_;
  const bool by_itself = phase_ == Phase::kApproach || phase_ == Phase::kExcite;
  return reason_ + (by_itself ? "; floats: goes down first" : "; floats: no thrust but downward");
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
    finish_mode(false, verdict_.missing.empty() ? "no MODEL came" : verdict_.words());
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

}  // namespace fathom::excitation

#include "common/estimation/online/estimator.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/config.hpp"
#include "common/base/spatial.hpp"

namespace fathom::estimation {
namespace {

constexpr int kPatience = 5;            // refused in a row before the estimate is taken to be the one that is wrong
constexpr double kSettling = 4.0;       // time constants of the position filter until its velocity counts
constexpr double kOffsetGain = 0.02;    // per sample: a datum does not move
constexpr double kStill = 0.01;         // m/s, rad/s
constexpr double kFirstInterval = 0.1;  // s, of a measurement without predecessor

AttitudeFilter attitude_filter(const EstimatorSettings& s) {
  return {s.attitude_cutoff,
          s.damping,
          {.rate = s.rate_noise, .bias_walk = s.bias_walk, .rate_walk = s.rate_walk, .bias_prior = s.bias_prior}};
}

TranslationFilter translation_filter(const EstimatorSettings& s) {
  return {s.position_cutoff,
          s.damping,
          s.velocity_cutoff,
          {.acceleration = s.acceleration_walk, .velocity_prior = 1.0}};  // m/s: what vehicles of this size do
}

}  // namespace

EstimatorSettings EstimatorSettings::from(const Config& config) {
  EstimatorSettings s;
  s.attitude_cutoff = config.positive("attitude_cutoff", "rad/s");
  s.position_cutoff = config.positive("position_cutoff", "rad/s");
  s.velocity_cutoff = config.positive("velocity_cutoff", "rad/s");
  s.damping = config.positive("damping", "");
  s.latency = config.positive("latency", "s");
  s.max_gap = config.positive("max_gap", "s");
  s.gate = config.positive("gate", "");
  s.position_noise = config.positive("position_noise", "m");
  s.attitude_noise = config.positive("attitude_noise", "rad");
  s.depth_noise = config.positive("depth_noise", "m");
  s.velocity_noise = config.positive("velocity_noise", "m/s");
  s.rate_noise = config.positive("rate_noise", "rad/s");
  s.bias_walk = config.positive("bias_walk", "rad/s");
  s.bias_prior = config.positive("bias_prior", "rad/s");
  s.acceleration_walk = config.positive("acceleration_walk", "m/s");
  s.rate_walk = config.positive("rate_walk", "rad/s");
  return s;
}

Estimator::Estimator(const EstimatorSettings& settings, const Corrections& corrections)
    : settings_{settings},
      corrections_{corrections},
      attitude_{attitude_filter(settings)},
      translation_{translation_filter(settings)} {
  one_pose_ = {.t = {0.0}, .p_WB = {Eigen::Vector3d::Zero()}, .q_WB = {Eigen::Quaterniond::Identity()}, .valid = {1}};
}

void Estimator::reset() { *this = Estimator{settings_, corrections_}; }

const Estimator::Output& Estimator::step(const PoseCapture& sample) {
  return take(sample.utime, corrections_.pose_shift, {.sample = sample});
}
const Estimator::Output& Estimator::step(const Ahrs& sample) {
  return take(sample.utime, corrections_.gyro_shift, {.sample = sample});
}
const Estimator::Output& Estimator::step(const Dvl& sample) {
  return take(sample.utime, corrections_.dvl_shift, {.sample = sample});
}
const Estimator::Output& Estimator::step(const Depth& sample) { return take(sample.utime, 0.0, {.sample = sample}); }

const Estimator::Output& Estimator::finish() {
  output_.clear();
  if (!waiting_.empty()) release(waiting_.back().utime);
  return output_;
}

const Estimator::Output& Estimator::take(Utime raw, double shift, Event event) {
  output_.clear();
  event.utime = utime_after(raw, shift);
  if (now_ && event.utime < *now_) {
    ++rejected_["late"];
    return output_;
  }
  newest_ = std::max(raw, newest_.value_or(raw));
  // At equal times the kinds have a fixed order, so that arrival does not matter there either.
  const auto place = std::upper_bound(waiting_.begin(), waiting_.end(), event, [](const Event& a, const Event& b) {
    return a.utime != b.utime ? a.utime < b.utime : a.sample.index() < b.sample.index();
  });
  waiting_.insert(place, std::move(event));
  release(utime_after(*newest_, -settings_.latency));
  return output_;
}

void Estimator::release(Utime until) {
  std::size_t done = 0;
  for (; done < waiting_.size() && waiting_[done].utime <= until; ++done) {
    const Event& event = waiting_[done];
    next_gyro_.reset();
    for (std::size_t i = done; i < waiting_.size() && !next_gyro_; ++i) {
      const auto* ahrs = std::get_if<Ahrs>(&waiting_[i].sample);
      if (ahrs != nullptr && ahrs->has_rates) next_gyro_ = Gyro{waiting_[i].utime, corrected_rates(*ahrs)};
    }
    advance(event.utime);
    std::visit([this](const auto& sample) { use(sample); }, event.sample);
    const bool gyro = std::holds_alternative<Ahrs>(event.sample) && std::get<Ahrs>(event.sample).has_rates;
    if (gyro || (std::holds_alternative<PoseCapture>(event.sample) && !fresh(gyro_track_))) say();
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done));
}

Eigen::Vector3d Estimator::corrected_rates(const Ahrs& sample) const {
  return corrections_.gyro.matrix() * sample.w_WB_B + corrections_.gyro.bias;
}

// Between two samples the rate goes in a straight line; without a next sample it stays.
Eigen::Vector3d Estimator::gyro_at(double seconds_after_last) const {
  const double gap = next_gyro_ ? seconds_between(last_gyro_.utime, next_gyro_->utime) : 0.0;
  if (gap <= 0.0 || gap > settings_.max_gap) return last_gyro_.w;
  return last_gyro_.w + (seconds_after_last / gap) * (next_gyro_->w - last_gyro_.w);
}

bool Estimator::fresh(const Track& track) const {
  return track.last && now_ && seconds_between(*track.last, *now_) <= settings_.max_gap;
}

double Estimator::interval(const Track& track, double otherwise) const {
  return track.last ? seconds_between(*track.last, *now_) : otherwise;
}

void Estimator::advance(Utime utime) {
  const double dt = now_ ? seconds_between(*now_, utime) : 0.0;
  const double since_gyro = now_ ? seconds_between(last_gyro_.utime, *now_) : 0.0;
  now_ = utime;
  if (!rotation_.last) return;
  if (!fresh(position_) && !fresh(velocity_)) moving_since_.reset();
  if (!fresh(gyro_track_)) attitude_.drop_gyro();
  if (dt <= 0.0) return;
  const Eigen::Matrix3d before = attitude_.attitude().toRotationMatrix();
  if (fresh(gyro_track_)) {
    attitude_.predict(dt, gyro_at(since_gyro + 0.5 * dt));
    attitude_.set_gyro(gyro_at(since_gyro + dt));
  } else {
    attitude_.predict(dt);
  }
  if (fresh(force_)) {
    const Eigen::Matrix3d middle = before * quaternion_from_rotation_vector(0.5 * dt * attitude_.rates());
    translation_.predict(dt, middle, last_force_);
  } else {
    translation_.predict(dt, attitude_.attitude().toRotationMatrix() * before.transpose());
  }
}

void Estimator::use(const Ahrs& sample) {
  if (sample.has_rates) {
    const Eigen::Vector3d w = corrected_rates(sample);
    const double dt = seconds_between(last_gyro_.utime, *now_);
    const bool known = fresh(gyro_track_) && dt > 0.0;
    if (sample.has_specific_force) {
      const SensorFault& fault = corrections_.accelerometer;
      const Eigen::Vector3d turning = known ? Eigen::Vector3d((w - last_gyro_.w) / dt) : Eigen::Vector3d::Zero();
      last_force_ =
          fault.matrix() * sample.f_B + fault.bias - turning.cross(fault.lever) - w.cross(w.cross(fault.lever));
      force_.last = now_;
    }
    attitude_.set_gyro(w);
    last_gyro_ = {*now_, w};
    gyro_track_.last = now_;
  }
  if (sample.has_attitude && !fresh(captured_)) use_attitude(sample.q_WB);
}

void Estimator::use(const PoseCapture& sample) {
  if (!sample.valid) {
    ++rejected_["pose invalid"];
    return;
  }
  // A capture that repeats itself to the last bit while the vehicle moves is frozen, not precise.
  const bool repeats =
      last_pose_ && last_pose_->p_WB == sample.p_WB && last_pose_->q_WB.coeffs() == sample.q_WB.coeffs();
  last_pose_ = sample;
  if (repeats && (translation_.velocity().norm() > kStill || attitude_.rates().norm() > kStill)) {
    ++rejected_["pose frozen"];
    return;
  }
  one_pose_.p_WB.front() = sample.p_WB;
  one_pose_.q_WB.front() = sample.q_WB;
  correct_pose(corrections_, one_pose_);
  if (sample.has_attitude) {
    captured_.last = now_;
    use_attitude(one_pose_.q_WB.front());
  }
  if (sample.has_position) {
    use_position(one_pose_.p_WB.front(), Eigen::Vector3d::Ones(), settings_.position_noise, position_,
                 "position gated");
  }
}

// The capture's world need not begin at the surface: while both are there the difference is learnt, not the depth.
void Estimator::use(const Depth& sample) {
  if (fresh(position_)) {
    const double seen = sample.z - translation_.position().z();
    depth_offset_ = depth_offset_ ? *depth_offset_ + kOffsetGain * (seen - *depth_offset_) : seen;
    return;
  }
  use_position({0.0, 0.0, sample.z - depth_offset_.value_or(0.0)}, Eigen::Vector3d::UnitZ(), settings_.depth_noise,
               depth_, "depth gated");
}

void Estimator::use(const Dvl& sample) {
  if (!sample.valid || sample.held || !rotation_.last) {
    ++rejected_[sample.held ? "dvl held" : (sample.valid ? "no attitude yet" : "dvl invalid")];
    return;
  }
  const SensorFault& fault = corrections_.dvl;
  const Eigen::Vector3d v_B =
      fault.matrix() * sample.v_WB_B + fault.bias + (skew(fault.lever) + fault.coupling) * attitude_.rates();
  const Eigen::Matrix3d R_WB = attitude_.attitude().toRotationMatrix();
  const bool first = !fresh(position_) && !fresh(velocity_);
  const Eigen::Vector3d error = R_WB * v_B - translation_.velocity();
  const double sigma = std::hypot(settings_.velocity_noise, translation_.sigma_velocity_body(R_WB).maxCoeff());
  if (first) {
    translation_.correct_velocity(error, 1e3, settings_.velocity_noise);  // nothing better is known: take it whole
  } else if (passes(error.norm(), sigma, velocity_, "dvl gated")) {
    translation_.correct_velocity(error, std::min(interval(velocity_, kFirstInterval), settings_.max_gap),
                                  settings_.velocity_noise);
  } else {
    return;
  }
  velocity_.last = now_;
  if (!moving_since_ || first) moving_since_ = utime_after(*now_, -kSettling / settings_.position_cutoff);
}

bool Estimator::passes(double error, double sigma, Track& track, const char* reason) {
  const bool good = error <= settings_.gate * sigma;
  if (good || ++track.refused > kPatience) {
    track.refused = 0;
    return true;
  }
  ++rejected_[reason];
  return false;
}

void Estimator::use_attitude(const Eigen::Quaterniond& q_WB) {
  if (!rotation_.last) {
    attitude_.start(q_WB, settings_.attitude_noise);
    rotation_.last = now_;
    return;
  }
  const double dt = std::min(interval(rotation_, kFirstInterval), settings_.max_gap);
  const Eigen::Vector3d error = attitude_.innovation(q_WB);
  const double sigma = std::hypot(settings_.attitude_noise, attitude_.sigma_rotation());
  if (dt <= 0.0 || !passes(error.norm(), sigma, rotation_, "attitude gated")) return;
  attitude_.correct(error, dt, settings_.attitude_noise);
  rotation_.last = now_;
}

void Estimator::use_position(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& axes, double sigma, Track& track,
                             const char* reason) {
  if (!rotation_.last) return;
  const bool whole = axes.minCoeff() > 0.0;
  if (whole && !fresh(track) && !fresh(velocity_)) {  // at the start and after a gap
    translation_.start(p_WB, Eigen::Vector3d::Constant(sigma));
    track = {.last = now_};
    moving_since_ = now_;
    return;
  }
  const double dt = std::min(interval(track, kFirstInterval), settings_.max_gap);
  const Eigen::Vector3d error = axes.cwiseProduct(p_WB - translation_.position());
  const double spread = std::hypot(sigma, translation_.sigma_position().cwiseProduct(axes).maxCoeff());
  if (dt <= 0.0 || (track.last && !passes(error.norm(), spread, track, reason))) return;
  translation_.correct_position(error, axes, dt, sigma, attitude_.attitude().toRotationMatrix());
  track.last = now_;
}

void Estimator::say() {
  if (!rotation_.last) return;
  StateEstimate state;
  state.utime = *now_;
  if (!output_.empty() && output_.back().utime == state.utime) output_.pop_back();
  const Eigen::Matrix3d R_WB = attitude_.attitude().toRotationMatrix();
  state.p_WB = translation_.position();
  state.q_WB = attitude_.attitude();
  state.nu << R_WB.transpose() * translation_.velocity(), attitude_.rates();
  state.sigma << translation_.sigma_position(), Eigen::Vector3d::Constant(attitude_.sigma_rotation()),
      translation_.sigma_velocity_body(R_WB), Eigen::Vector3d::Constant(attitude_.sigma_rates());
  state.covariance.topLeftCorner<3, 3>() = state.sigma.head<3>().cwiseAbs2().asDiagonal();
  state.covariance.bottomRightCorner<3, 3>() = state.sigma.segment<3>(6).cwiseAbs2().asDiagonal();
  const auto age = [&](Source source, const Track& track) {
    if (track.last) state.age[static_cast<std::size_t>(source)] = seconds_between(*track.last, *now_);
  };
  age(Source::kAhrs, gyro_track_);
  age(Source::kPoseCapture, position_.last ? position_ : captured_);
  age(Source::kDvl, velocity_);
  age(Source::kDepth, depth_);
  state.valid = fresh(rotation_) && (fresh(position_) || fresh(velocity_)) && moving_since_ &&
                seconds_between(*moving_since_, *now_) * settings_.position_cutoff >= kSettling && state.nu.allFinite();
  output_.push_back(state);
}

}  // namespace fathom::estimation

// Order in time: what waits, where the filter is, when it begins and when it is lost. What each instrument tells stands
// in joint_intake.cpp and joint_rows.cpp.
#include "common/joint/joint_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/config.hpp"
#include "common/base/spatial.hpp"
#include "common/model/priors/expected_inertia.hpp"
#include "common/model/priors/wide_prior.hpp"

namespace fathom::joint {
namespace {

constexpr std::size_t kHistory = 512;    // states: 5 s at 100 Hz
constexpr double kUnknownMass = 3.0;     // of 1/m's prior: its standard deviation, unknown to a factor of four
constexpr double kLightest = 20.0;       // times lighter than expected than which nothing is taken to be
constexpr double kWellKnown = 0.15;      // share of an inertia: so well it must be known for an axis to begin
constexpr double kStartSpeed = 0.02;     // m/s added to what STATE says of itself: it has seen the same samples
constexpr double kStartPosition = 0.01;  // m likewise

std::vector<model::BaseParameter> columns_of(const model::Vehicle& vehicle) {
  std::vector<model::BaseParameter> columns;
  for (const std::string& name : vehicle.parameters) columns.push_back(model::parameter_from_name(name).value());
  return columns;
}

// What a vehicle of this size weighs; its file's number only where it states no mass.
double about(const model::Vehicle& vehicle, std::size_t k, model::BaseParameter parameter) {
  return vehicle.mass > 0.0 ? model::wide_prior(parameter, vehicle).mean : std::abs(vehicle.priors[k].mean);
}

struct Prior {
  ParameterVector mean, sigma, heaviest;
};

Prior prior_of(const identification::IdentifierSettings& settings, const model::Vehicle& vehicle) {
  const auto columns = columns_of(vehicle);
  const auto n = static_cast<Eigen::Index>(columns.size());
  const Vector6d heavier = model::inertia_beside_lbv150(vehicle);
  Vector6d expected = Vector6d::Zero();  // of the axis
  Prior prior{ParameterVector::Zero(n), ParameterVector::Zero(n), ParameterVector::Ones(n)};
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (model::index(columns[k]) >= 6) continue;
    const double mass = settings.from_zero ? about(vehicle, k, columns[k]) : vehicle.priors[k].mean;
    expected[model::axis(columns[k])] = mass;
  }
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const int axis = model::axis(columns[k]);
    const double mass = expected[axis] > 0.0 ? expected[axis] : 1.0;
    prior.heaviest(i) = kLightest * mass;
    if (model::index(columns[k]) < 6) {
      prior.mean(i) = 1.0 / mass;
      prior.sigma(i) = settings.from_zero ? kUnknownMass / mass : vehicle.priors[k].sigma / (mass * mass);
    } else {
      prior.mean(i) = settings.from_zero ? 0.0 : vehicle.priors[k].mean / mass;
      prior.sigma(i) = (settings.from_zero ? settings.zero_sigma * heavier[axis] : vehicle.priors[k].sigma) / mass;
    }
  }
  return prior;
}

JointNoise noise_of(const JointSettings& settings, const identification::IdentifierSettings& identifier,
                    const estimation::NavigatorSettings& navigator) {
  JointNoise noise;
  noise.acceleration = settings.acceleration;
  noise.turning = settings.turning;
  noise.bias_walk = navigator.bias_walk;
  noise.bias_prior = navigator.bias_prior;
  noise.attitude = navigator.attitude_noise;
  noise.attitude_memory = settings.attitude_memory;
  noise.scale = identifier.velocity_scale;
  noise.height = navigator.laser.used ? std::hypot(navigator.tags.systematic, navigator.laser.systematic) : 0.0;
  noise.offset.setConstant(navigator.dvl.used ? identifier.velocity_offset : 0.0);
  noise.turned = settings.mounting;
  return noise;
}

double longest_delay(const estimation::NavigatorSettings& s) {
  double longest = 0.0;
  for (const estimation::AidSettings* aid : {&s.tags, &s.flow, &s.laser, &s.dvl, &s.usbl, &s.depth}) {
    if (aid->used) longest = std::max(longest, aid->delay);
  }
  return longest;
}

}  // namespace

JointSettings JointSettings::from(const Config& config) {
  JointSettings s;
  s.acceleration = config.positive("unmodelled_acceleration", "m/s^2");
  s.turning = config.positive("unmodelled_turning", "rad/s^2");
  s.attitude_memory = config.positive("attitude_memory", "s");
  s.inertial_scale = config.not_negative("inertial_scale", "");
  if (config.has("mounting")) s.mounting = config.not_negative("mounting", "rad");
  return s;
}

JointEstimate::JointEstimate(const JointSettings& settings, const identification::IdentifierSettings& identifier,
                             const estimation::NavigatorSettings& navigator, const estimation::NavigatorPlaces& places,
                             const model::Vehicle& vehicle)
    : settings_{settings},
      navigator_{navigator},
      places_{places},
      max_input_gap_{identifier.max_input_gap},
      freeze_delay_{identifier.freeze_delay},
      attitude_offset_{identifier.attitude_offset},
      lag_{longest_delay(navigator)},
      filter_{[&] {
        const Prior prior = prior_of(identifier, vehicle);
        return JointFilter{Normalised{vehicle, columns_of(vehicle), prior.heaviest},
                           noise_of(settings, identifier, navigator), prior.mean, prior.sigma};
      }()},
      prior_{filter_} {
  waiting_.reserve(2 * kHistory);
  states_.resize(kHistory);
}

void JointEstimate::wait(const Event& event) {
  if (!(event.a.allFinite() && event.b.allFinite() && event.tau.allFinite() && std::isfinite(event.sigma) &&
        event.q_WB.coeffs().allFinite())) {
    ++rejected_["joint estimate: not finite"];
    return;
  }
  if (now_ && event.utime <= *now_) {
    ++rejected_["joint estimate: late"];
    return;
  }
  const auto place = std::upper_bound(
      waiting_.begin() + static_cast<std::ptrdiff_t>(done_), waiting_.end(), event,
      [](const Event& a, const Event& b) { return a.utime != b.utime ? a.utime < b.utime : a.kind < b.kind; });
  if (waiting_.size() == waiting_.capacity()) {
    if (done_ == 0) {  // nothing moves on: no attitude comes
      ++rejected_["joint estimate: without attitude"];
      return;
    }
    const auto kept = place - (waiting_.begin() + static_cast<std::ptrdiff_t>(done_));
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done_));
    done_ = 0;
    waiting_.insert(waiting_.begin() + kept, event);
    return;
  }
  waiting_.insert(place, event);
}

void JointEstimate::hear(const Ahrs& sample) {
  if (!sample.has_attitude || !sample.has_rates || !sample.has_specific_force) return;
  wait({.utime = sample.utime, .kind = Kind::kAttitude, .q_WB = sample.q_WB, .a = sample.w_WB_B, .b = sample.f_B});
}

// Only times that a state has confirmed move the clock: an attitude from the future must not.
void JointEstimate::hear(const StateEstimate& state) {
  if (newest_ && state.utime <= *newest_) return;
  newest_ = state.utime;
  newest_state_ = (newest_state_ + 1) % kHistory;
  states_[newest_state_] = state;
}

void JointEstimate::hear(Utime utime, const Vector6d& tau) { wait({.utime = utime, .kind = Kind::kInput, .tau = tau}); }

void JointEstimate::hear(Utime utime, std::vector<int> held) {
  if (!wishes_.empty() && utime <= wishes_.back().utime) return;
  wishes_.push_back({utime, std::move(held)});
}

void JointEstimate::obey(Utime utime) {
  while (!wishes_.empty() && seconds_between(wishes_.front().utime, utime) >= freeze_delay_) {
    held_ = wishes_.front().held;
    for (int k = 0; k < filter_.model().size(); ++k) filter_.hold(k, std::ranges::find(held_, k) != held_.end());
    wishes_.erase(wishes_.begin());
  }
}

const StateEstimate* JointEstimate::state_at(Utime utime) const {
  for (std::size_t i = 0; i < kHistory; ++i) {
    const StateEstimate& state = states_[(newest_state_ + kHistory - i) % kHistory];
    if (state.utime == utime) return &state;
    if (state.utime < utime) break;
  }
  return nullptr;
}

std::optional<Utime> JointEstimate::next() {
  while (newest_ && done_ < waiting_.size()) {
    // An attitude takes everything before it along.
    std::size_t attitude = done_;
    while (attitude < waiting_.size() && waiting_[attitude].kind != Kind::kAttitude) ++attitude;
    if (attitude == waiting_.size() || seconds_between(waiting_[attitude].utime, *newest_) < lag_) return std::nullopt;
    const Event until = waiting_[attitude];
    const StateEstimate* state = state_at(until.utime);
    const bool good = state != nullptr && state->valid;
    ahead_ = until;
    std::size_t i = done_;
    while (i < attitude) {
      std::size_t end = i + 1;
      while (end < attitude && waiting_[end].utime == waiting_[i].utime && waiting_[end].kind == waiting_[i].kind)
        ++end;
      if (waiting_[i].kind == Kind::kInput) {
        if (running_ && good) go_to(waiting_[i].utime);
        tau_ = waiting_[end - 1].tau;
        input_at_ = waiting_[i].utime;
      } else if (running_ && good && before_) {
        go_to(waiting_[i].utime);
        use(i, end);
      }
      i = end;
    }
    done_ = attitude + 1;
    take_attitude(until);
    if (good) return until.utime;
  }
  return std::nullopt;
}

void JointEstimate::lose(const char* why) {
  if (running_) ++rejected_[std::string{"joint estimate: begun anew, "} + why];
  running_ = false;
}

// The attitude that next() has reached.
void JointEstimate::take_attitude(const Event& event) {
  const StateEstimate* state = state_at(event.utime);
  if (state == nullptr || !state->valid) {
    lose("no valid state");
    now_ = event.utime;
    before_.reset();
    attitudes_ = 0;
    return;
  }
  obey(event.utime);
  const bool fed = input_at_ && seconds_between(*input_at_, event.utime) <= max_input_gap_;
  if (before_ && seconds_between(before_->utime, event.utime) > navigator_.max_gap) lose("a gap in the attitudes");
  if (running_ && !fed) lose("no input");
  if (running_) {
    follow_attitude(event);
  } else if (fed) {
    begin(event);
  }
  now_ = event.utime;
  before_ = event;
  lately_[static_cast<std::size_t>(attitudes_++ % 4)] = event;
}

void JointEstimate::begin(const Event& event) {
  const StateEstimate& state = *state_at(event.utime);
  Vector6d sigma;
  sigma << state.sigma.head<3>().array() + kStartPosition, state.sigma.segment<3>(6).array() + kStartSpeed;
  filter_.start(state.p_WB, state.nu, sigma, 2.0 * navigator_.rate_noise);
  running_ = true;
  refused_in_a_row_ = 0;
}

void JointEstimate::follow_attitude(const Event& event) {
  const double dt = seconds_between(before_->utime, event.utime);
  go_to(event.utime);
  use_inertial(event, dt);
  constexpr double kFastest = 20.0;  // m/s and rad/s: beyond, it is not the vehicle that moves so
  if (!filter_.sane()) return begin_anew("its numbers were impossible");
  if (filter_.nu().cwiseAbs().maxCoeff() > kFastest) lose("it ran away");
}

// What was learnt is of no use: the recursive estimate has to teach it once more.
void JointEstimate::begin_anew(const char* why) {
  lose(why);
  filter_ = prior_;
  for (const int k : held_) filter_.hold(k, true);
  started_ = false;
  colour_ = {};
}

Eigen::Matrix3d JointEstimate::told(Utime utime) const {
  const double whole = seconds_between(before_->utime, ahead_->utime);
  const double share = whole > 0.0 ? std::clamp(seconds_between(before_->utime, utime) / whole, 0.0, 1.0) : 1.0;
  return before_->q_WB.slerp(share, ahead_->q_WB).toRotationMatrix();
}

void JointEstimate::go_to(Utime utime) {
  if (!before_ || !now_ || utime <= *now_) return;
  const double dt = seconds_between(*now_, utime);
  filter_.predict(dt, told(*now_), told(*now_ + (utime - *now_) / 2), told(utime), tau_);
  now_ = utime;
}

ParameterMatrix JointEstimate::covariance() const {
  const ParameterMatrix slope = filter_.model().physical_slope(filter_.parameters());
  ParameterMatrix all = slope * filter_.parameter_covariance() * slope.transpose();
  ParameterVector wider(all.rows());
  for (int k = 0; k < filter_.model().size(); ++k) {
    const int axis = model::axis(filter_.model().parameters()[static_cast<std::size_t>(k)]);
    wider(k) = std::sqrt(colour_[static_cast<std::size_t>(axis)].ratio());
  }
  all = wider.asDiagonal() * all * wider.asDiagonal();
  add_systematic(all);
  return all;
}

// What no residual shows. An accelerometer's axis that is off by a share s explains every force as well with a mass
// divided by 1 + s; a gyro's axis with inertia and linear drag divided by it, and quadratic drag by its square. An
// attitude that is off turns the restoring moment.
void JointEstimate::add_systematic(ParameterMatrix& covariance) const {
  using enum model::BaseParameter;
  const auto& parameters = filter_.model().parameters();
  const ParameterVector known = estimate();
  std::array<ParameterVector, 6> off;
  off.fill(ParameterVector::Zero(known.size()));
  int righting = -1;
  for (int k = 0; k < filter_.model().size(); ++k) {
    const model::BaseParameter parameter = parameters[static_cast<std::size_t>(k)];
    const int axis = model::axis(parameter);
    if (parameter == G_z) righting = k;
    if (parameter >= W_B || (axis < 3 && parameter > m_Z)) continue;
    off[static_cast<std::size_t>(axis)](k) = settings_.inertial_scale * (parameter >= X_uu ? 2.0 : 1.0) * known(k);
  }
  for (const ParameterVector& along : off) covariance += along * along.transpose();
  for (int k = 0; righting >= 0 && k < filter_.model().size(); ++k) {
    const model::BaseParameter parameter = parameters[static_cast<std::size_t>(k)];
    if (parameter != G_x && parameter != G_y) continue;
    covariance(k, k) += std::pow(attitude_offset_ * known(righting), 2.0);
  }
}

void JointEstimate::offer(const ParameterVector& mean, const ParameterMatrix& covariance) {
  if (started_) return;
  const Normalised& model = filter_.model();
  started_ = true;
  for (int axis = 0; axis < 6; ++axis) {
    const int k = model.inertia_of(axis);
    if (k < 0 || model.moves(axis) || !model.simulated(axis)) continue;
    if (mean(k) > 0.0 && std::sqrt(covariance(k, k)) < kWellKnown * mean(k)) filter_.teach(axis, mean, covariance);
    started_ = started_ && (filter_.model().moves(axis) || !model.simulated(axis));
  }
  if (started_) filter_.teach_rest(mean, covariance);
}

bool JointEstimate::restore(const ParameterVector& mean, const ParameterMatrix& covariance) {
  if (!filter_.restore(mean, covariance)) return false;
  started_ = true;
  return true;
}

}  // namespace fathom::joint

// Streams to samples to rows. Samples of the warm-up are kept, tell the scene, and are then used like all others.
#include "common/diagnosis/live_diagnoser.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace fathom::diagnosis {
namespace {

using identification::IntegralRegressor;
using identification::RowBlock;

constexpr double kMaxRate = 100.0;      // 1/s: twenty times the bandwidth of a 2 s window
constexpr double kPositionKnown = 5.0;  // m, std: worse than that says nothing about a tether
constexpr double kWarmUpGap = 5.0;      // s without motion after which a warm-up starts over
constexpr double kSmallestMass = 0.1;   // of the prior mean: keeps a poor first fit physical

}  // namespace

LiveDiagnoser::LiveDiagnoser(const LiveSettings& settings, const model::Vehicle& vehicle)
    : settings_{settings},
      vehicle_{std::make_unique<const model::Vehicle>(vehicle)},
      parameters_{[&] {
        std::vector<model::BaseParameter> columns;
        for (const std::string& name : vehicle.parameters) {
          const auto parameter = model::parameter_from_name(name);
          if (!parameter) throw InputError("vehicle '" + vehicle.name + "': unknown parameter '" + name + "'");
          columns.push_back(*parameter);
        }
        return columns;
      }()},
      aligner_{{.interpolate = settings.interpolate_input,
                .max_input_gap = settings.max_input_gap,
                .max_skew = settings.max_skew,
                .voltage = true}},
      prior_mean_{[&] {
        identification::ParameterVector mean(static_cast<Eigen::Index>(vehicle.priors.size()));
        for (Eigen::Index i = 0; i < mean.size(); ++i) mean[i] = vehicle.priors[static_cast<std::size_t>(i)].mean;
        return mean;
      }()},
      regressor_{integral_settings()} {}

identification::IntegralSettings LiveDiagnoser::integral_settings() const {
  identification::IntegralSettings s;
  s.window = settings_.window;
  s.stride = settings_.stride;
  s.max_gap = settings_.max_gap;
  s.max_rate = kMaxRate;
  s.dof = vehicle_->dof;
  s.parameters = parameters_;
  return s;
}

const std::vector<LiveForm>& LiveDiagnoser::forms() const {
  static const std::vector<LiveForm> kNone;
  return candidates_ ? candidates_->columns.forms() : kNone;
}

std::optional<EffectRanking> LiveDiagnoser::step(const StateEstimate& state) {
  if (!aligner_.push(state)) {
    reject("late");
    return std::nullopt;
  }
  return release(false);
}

std::optional<EffectRanking> LiveDiagnoser::step(const Thrusters& thrusters) {
  const auto count = static_cast<Eigen::Index>(vehicle_->thrusters.size());
  const auto matches = [count](const std::vector<double>& values) {
    return count > 0 && static_cast<Eigen::Index>(values.size()) == count;
  };
  const bool has_force = matches(thrusters.force);
  const bool has_curve = matches(thrusters.pwm_us) && !vehicle_->curve.empty();
  if (source_ == Source::kUnknown && (has_force || has_curve || thrusters.has_tau)) {
    source_ = has_force ? Source::kForce : has_curve ? Source::kCurve : Source::kWrench;
    nominal_ = model::nominal_model(*vehicle_, source_ == Source::kWrench);
  }
  model::ActuatorForces input;
  if (source_ == Source::kForce && has_force) {
    input = Eigen::Map<const Eigen::VectorXd>(thrusters.force.data(), count);
  } else if (source_ == Source::kCurve && has_curve) {
    input.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto j = static_cast<std::size_t>(i);
      input[i] =
          vehicle_->curve.force_at(thrusters.pwm_us[j], vehicle_->thrusters[j].pwm_sign, vehicle_->curve.voltage);
    }
  } else if (source_ == Source::kWrench && thrusters.has_tau) {
    input = Eigen::Map<const Vector6d>(thrusters.tau.data());
  } else {
    reject("no force");
    return std::nullopt;
  }
  if (!input.allFinite()) {
    reject("not finite");
    return std::nullopt;
  }
  if (!aligner_.push_input(thrusters.utime, input)) {
    reject("late");
    return std::nullopt;
  }
  return release(false);
}

std::optional<EffectRanking> LiveDiagnoser::step(const Battery& battery) {
  if (!(std::isfinite(battery.voltage) && battery.voltage > 0.0)) {
    reject("not finite");
    return std::nullopt;
  }
  if (!aligner_.push_voltage(battery.utime, battery.voltage)) reject("late");
  return release(false);
}

std::optional<EffectRanking> LiveDiagnoser::finish() {
  std::optional<EffectRanking> ranking = release(true);
  if (!candidates_ && !warm_up_.empty()) prepare();
  if (candidates_) candidates_->evidence.close_block();
  return newest_ > 0 ? std::optional{rank(newest_)} : ranking;
}

std::optional<EffectRanking> LiveDiagnoser::release(bool all) {
  std::optional<EffectRanking> ranking;
  while (const auto aligned = aligner_.next(all)) {
    if (source_ == Source::kUnknown) {  // nothing to explain motion with yet
      reject("no input");
      continue;
    }
    const Sample sample = sample_of(*aligned);
    if (sample.motion.valid) newest_ = sample.motion.utime;
    if (!candidates_) {
      if (!sample.motion.valid) continue;
      if (!warm_up_.empty() && seconds_between(warm_up_.back().motion.utime, sample.motion.utime) > kWarmUpGap) {
        forget_motion();
      }
      if (!origin_) origin_ = sample.motion.utime;
      record_input(sample);
      warm_up_.push_back(sample);
      if (seconds_between(warm_up_.front().motion.utime, sample.motion.utime) < settings_.warm_up) continue;
      prepare();
      ranking = rank(sample.motion.utime);
      continue;
    }
    if (sample.motion.valid) record_input(sample);
    use(sample, ranking);
  }
  return ranking;
}

LiveDiagnoser::Sample LiveDiagnoser::sample_of(const identification::StreamAligner::Aligned& aligned) {
  const StateEstimate& state = aligned.state;
  Sample sample;
  sample.motion.utime = state.utime;
  if (!state.valid) {
    reject("state invalid");
  } else if (!(state.nu.allFinite() && state.q_WB.coeffs().allFinite() && state.p_WB.allFinite())) {
    reject("not finite");
  } else if (!aligned.input) {
    reject("no input");
  } else {
    sample.motion.valid = true;
    sample.motion.nu = state.nu;
    sample.motion.down_B = state.q_WB.conjugate() * Eigen::Vector3d::UnitZ();
    sample.p_WB = state.p_WB;
    sample.q_WB = state.q_WB;
    sample.has_position = state.sigma.head<3>().maxCoeff() < kPositionKnown;
    sample.voltage = aligned.voltage;
    if (source_ == Source::kCurve && sample.voltage > 0.0 && vehicle_->curve.voltage > 0.0) {
      sample.boost = std::pow(sample.voltage / vehicle_->curve.voltage, vehicle_->curve.voltage_exponent);
    }
    sample.force = sample.boost * *aligned.input;
    sample.motion.tau = nominal_.allocation * sample.force;
  }
  return sample;
}

model::Scene LiveDiagnoser::scene() const {
  model::Scene scene{.vehicle = vehicle_.get(), .position = true, .attitude = true, .velocity = true, .rates = true};
  scene.input_is_wrench = source_ == Source::kWrench;
  const Sample& first = warm_up_.front();
  scene.duration = seconds_between(first.motion.utime, warm_up_.back().motion.utime);
  scene.p_low = scene.p_high = first.p_WB;
  scene.force_rms = model::ActuatorForces::Zero(nominal_.allocation.cols());
  double low = first.voltage, high = first.voltage;
  for (const Sample& sample : warm_up_) {
    scene.position = scene.position && sample.has_position;
    scene.p_low = scene.p_low.cwiseMin(sample.p_WB).eval();
    scene.p_high = scene.p_high.cwiseMax(sample.p_WB).eval();
    scene.nu_rms += sample.motion.nu.cwiseAbs2();
    scene.tau_rms += sample.motion.tau.cwiseAbs2();
    scene.force_rms += sample.force.cwiseAbs2();
    scene.mean_voltage += sample.voltage / static_cast<double>(warm_up_.size());
    low = std::min(low, sample.voltage);
    high = std::max(high, sample.voltage);
  }
  const auto count = static_cast<double>(warm_up_.size());
  scene.nu_rms = (scene.nu_rms / count).cwiseSqrt().eval();
  scene.tau_rms = (scene.tau_rms / count).cwiseSqrt().eval();
  scene.force_rms = (scene.force_rms / count).cwiseSqrt().eval();
  scene.voltage = low > 0.0;
  scene.voltage_range = high - low;
  return scene;
}

// A first fit of the base model: drag and masses for effects that alter what the hull feels, and the size of the
// residual per axis, which weighs the axes against each other.
model::Model LiveDiagnoser::base_from_warm_up(Vector6d& sigma) {
  IntegralRegressor regressor{integral_settings()};
  std::vector<RowBlock> blocks;
  for (const Sample& sample : warm_up_) {
    if (const auto block = regressor.step(sample.motion)) blocks.push_back(*block);
  }
  const Eigen::Index n = prior_mean_.size();
  Vector6d scale = Vector6d::Zero();
  Vector6d count = Vector6d::Zero();
  for (const RowBlock& block : blocks) {
    for (const auto& row : block.view()) {
      scale[row.axis] += row.y * row.y;
      count[row.axis] += 1.0;
    }
  }
  sigma = (scale.array() / count.array().max(1.0)).sqrt().max(1e-3) * 0.1;
  Eigen::VectorXd theta = prior_mean_;
  for (int round = 0; round < 3; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double prior = vehicle_->priors[static_cast<std::size_t>(i)].sigma;
      normal(i, i) = 1.0 / (prior * prior);
      right[i] = prior_mean_[i] / (prior * prior);
    }
    for (const RowBlock& block : blocks) {
      for (const auto& row : block.view()) {
        const double weight = 1.0 / (sigma[row.axis] * sigma[row.axis]);
        normal += weight * row.h * row.h.transpose();
        right += weight * row.y * row.h;
      }
    }
    theta = normal.ldlt().solve(right);
    Vector6d square = Vector6d::Zero();
    for (const RowBlock& block : blocks) {
      for (const auto& row : block.view()) square[row.axis] += std::pow(row.y - row.h.dot(theta), 2);
    }
    for (int axis = 0; axis < 6; ++axis) {
      const double freedom = std::max(count[axis] - 4.0, 1.0);  // about four parameters per axis
      if (count[axis] > 0.0) sigma[axis] = std::max(std::sqrt(square[axis] / freedom), 1e-4);
    }
  }
  model::Model model = nominal_;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    double value = theta[static_cast<Eigen::Index>(i)];
    const double mean = prior_mean_[static_cast<Eigen::Index>(i)];
    if (model::sign_constraint(parameters_[i]) > 0) value = std::max(value, kSmallestMass * mean);
    if (model::sign_constraint(parameters_[i]) < 0) value = std::min(value, 0.0);
    model.theta[model::index(parameters_[i])] = value;
  }
  return model;
}

void LiveDiagnoser::prepare() {
  const model::Model base = base_from_warm_up(sigma_);
  Eigen::VectorXd information(prior_mean_.size());
  for (Eigen::Index i = 0; i < information.size(); ++i) {
    information[i] = std::pow(vehicle_->priors[static_cast<std::size_t>(i)].sigma, -2);
  }
  std::vector<LiveEvidence::Mass> masses;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    if (model::sign_constraint(parameters_[i]) > 0) masses.push_back({column, prior_mean_[column]});
  }
  candidates_ = std::make_unique<Candidates>(base, scene(), information, std::move(masses),
                                             static_cast<std::size_t>(settings_.most_blocks));
  Candidates& c = *candidates_;
  c.wrench.assign(regressor_.capacity(), WrenchColumns::Zero(6, c.columns.columns()));
  c.momentum.assign(regressor_.capacity(),
                    WrenchColumns::Zero(6, static_cast<Eigen::Index>(c.columns.inertial().size())));
  c.filtered.setZero(6, c.columns.columns());
  c.rate.setZero(6, static_cast<Eigen::Index>(c.columns.inertial().size()));
  c.row.setZero(prior_mean_.size() + 1 + c.columns.columns());
  const std::vector<Sample> kept = std::move(warm_up_);
  warm_up_.clear();
  last_.reset();
  std::optional<EffectRanking> none;
  for (const Sample& sample : kept) use(sample, none);
}

}  // namespace fathom::diagnosis

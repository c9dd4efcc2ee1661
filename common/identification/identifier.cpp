// From aligned streams to rows; the mathematics is in the regressor and the estimator.
#include "common/identification/identifier.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/base/error.hpp"
#include "common/model/actuators.hpp"
#include "common/model/effect_size.hpp"
#include "common/model/priors/expected_inertia.hpp"

namespace fathom::identification {
namespace {

std::vector<model::BaseParameter> columns_of(const model::Vehicle& vehicle) {
  if (vehicle.parameters.empty()) {
    throw InputError("vehicle '" + vehicle.name + "': enables no parameter; list at least a mass under parameters");
  }
  if (vehicle.priors.size() != vehicle.parameters.size()) {
    throw InputError("vehicle '" + vehicle.name + "': needs one prior per parameter");
  }
  std::vector<model::BaseParameter> columns;
  for (const std::string& name : vehicle.parameters) {
    const auto parameter = model::parameter_from_name(name);
    if (!parameter)
      throw InputError("vehicle '" + vehicle.name + "': unknown parameter '" + name +
                       "'; see docs/model.md for the names");
    columns.push_back(*parameter);
  }
  return columns;
}

IntegralSettings integral_settings(const IdentifierSettings& settings, const model::Vehicle& vehicle) {
  IntegralSettings s;
  s.window = settings.window;
  s.stride = settings.stride;
  s.max_gap = settings.max_gap;
  s.dof = vehicle.dof;
  s.sigma << Eigen::Vector3d::Constant(settings.noise_force), Eigen::Vector3d::Constant(settings.noise_moment);
  const Vector6d mass = model::expected_inertia(vehicle);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double noise = settings.noise_acceleration * mass[i];
    s.sigma[i] = std::hypot(s.sigma[i], noise);
    if (settings.noise_velocity > 0.0) {
      s.per_velocity[i] = noise / settings.noise_velocity;
      s.mass[i] = mass[i];
    }
  }
  s.ordinary_sigma_v = settings.noise_velocity;
  s.parameters = columns_of(vehicle);
  return s;
}

RecursiveSettings recursive_settings(const IdentifierSettings& settings, const model::Vehicle& vehicle) {
  const std::vector<model::BaseParameter> columns = columns_of(vehicle);
  const auto n = static_cast<Eigen::Index>(columns.size());
  const Vector6d heavier = model::inertia_beside_lbv150(vehicle);
  RecursiveSettings s;
  s.mean.resize(n);
  s.sigma.resize(n);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    s.mean(static_cast<Eigen::Index>(i)) = vehicle.priors[i].mean;
    s.sigma(static_cast<Eigen::Index>(i)) = vehicle.priors[i].sigma;
    if (!(vehicle.priors[i].sigma > 0.0)) {
      throw InputError("vehicle '" + vehicle.name + "': prior of " + vehicle.parameters[i] +
                       " needs sigma > 0; a known constant gets a small one");
    }
    if (settings.from_zero) {
      s.mean(static_cast<Eigen::Index>(i)) = 0.0;
      s.sigma(static_cast<Eigen::Index>(i)) = settings.zero_sigma * heavier[model::axis(columns[i])];
    }
    s.signs[i] = static_cast<std::int8_t>(model::sign_constraint(columns[i]));
    if (settings.buoyant && columns[i] == model::BaseParameter::W_B) s.signs[i] = -1;
  }
  if (settings.memory > 0.0) s.forgetting = std::exp(-settings.stride / settings.memory);
  return s;
}

}  // namespace

Identifier::Identifier(const IdentifierSettings& settings, const model::Vehicle& vehicle)
    : settings_{settings},
      vehicle_{std::make_unique<const model::Vehicle>(vehicle)},
      parameters_{columns_of(vehicle)},
      regressor_{integral_settings(settings, vehicle)},
      estimator_{recursive_settings(settings, vehicle)},
      aligner_{{.interpolate = settings.interpolate_input,
                .max_input_gap = settings.max_input_gap,
                .max_skew = settings.max_skew}},
      misfit_{estimator_.size()} {}

const Identifier::Output& Identifier::step(const StateEstimate& state) {
  output_.clear();
  if (!aligner_.push(state)) {
    reject("late");
    return output_;
  }
  if (!offered_.empty()) decide(state.utime);
  release();
  return output_;
}

void Identifier::hear(const Excitation& excitation) {
  const std::vector<std::string>& last = wishes_.empty() ? frozen_ : wishes_.back().frozen;
  if (excitation.frozen == last) return;
  if (!wishes_.empty() && excitation.utime <= wishes_.back().utime) return;
  wishes_.push_back({excitation.utime, excitation.frozen});
}

// By time stamps alone, so that it does not matter when the wish arrived.
void Identifier::obey(Utime utime) {
  while (!wishes_.empty() && seconds_between(wishes_.front().utime, utime) >= settings_.freeze_delay) {
    for (const std::string& name : frozen_) resume(name);
    frozen_ = std::move(wishes_.front().frozen);
    for (const std::string& name : frozen_) freeze(name);
    wishes_.erase(wishes_.begin());
  }
}

// The first usable message decides whether single forces or the wrench are the input: an effect of one thruster needs
// the former, and the two cannot be mixed.
const Identifier::Output& Identifier::step(const Thrusters& thrusters) {
  output_.clear();
  if (input_ == InputKind::kUnknown) {
    input_ = InputKind::kForce;
    if (!input_of(thrusters)) input_ = thrusters.has_tau ? InputKind::kWrench : InputKind::kUnknown;
  }
  const std::optional<model::ActuatorForces> input = input_of(thrusters);
  if (!input) {
    reject("no force");
  } else if (!input->allFinite()) {
    reject("not finite");
  } else if (!aligner_.push_input(thrusters.utime, *input)) {
    reject("late");
  } else {
    release();
  }
  return output_;
}

std::optional<model::ActuatorForces> Identifier::input_of(const Thrusters& thrusters) const {
  const auto actuators = static_cast<Eigen::Index>(thrusters.force.size());
  if (input_ == InputKind::kForce) {
    if (actuators == 0 || actuators != vehicle_->allocation.cols() || actuators > model::kMaxActuators)
      return std::nullopt;
    return model::ActuatorForces{Eigen::Map<const Eigen::VectorXd>(thrusters.force.data(), actuators)};
  }
  if (input_ == InputKind::kUnknown || !thrusters.has_tau) return std::nullopt;
  return model::ActuatorForces{Eigen::Map<const Vector6d>(thrusters.tau.data())};
}

std::optional<Vector6d> Identifier::wrench(const Thrusters& thrusters) const {
  const std::optional<model::ActuatorForces> input = input_of(thrusters);
  if (!input || !input->allFinite()) return std::nullopt;
  return input_ == InputKind::kForce ? Vector6d{vehicle_->allocation * *input} : Vector6d{*input};
}

void Identifier::release() {
  while (const auto aligned = aligner_.next()) {
    const StateEstimate& state = aligned->state;
    EffectSample sample;
    sample.utime = state.utime;
    if (!state.valid) {
      reject("state invalid");
    } else if (!(state.nu.allFinite() && state.q_WB.coeffs().allFinite() && state.p_WB.allFinite())) {
      reject("not finite");
    } else if (!aligned->input) {
      reject("no input");
    } else {
      sample.p_WB = state.p_WB;
      sample.q_WB = state.q_WB;
      sample.nu = state.nu;
      sample.sigma_v = state.sigma.segment<3>(6);
      sample.force = *aligned->input;
      sample.voltage = voltage_;
      sample.valid = true;
      if (origin_ == 0) origin_ = sample.utime;
    }
    use(sample);
  }
}

// The rows of the window that this sample closes, the adopted effect's columns among them.
std::optional<RowBlock> Identifier::rows_of(const EffectSample& sample) {
  MotionSample motion{.utime = sample.utime, .nu = sample.nu, .sigma_v = sample.sigma_v, .valid = sample.valid};
  if (sample.valid) {
    motion.down_B = sample.q_WB.conjugate() * Eigen::Vector3d::UnitZ();
    if (input_ == InputKind::kForce) {
      model::Motion felt{.R_WB = sample.q_WB.toRotationMatrix(), .nu = sample.nu, .vehicle = vehicle_.get()};
      felt.force = sample.force;
      motion.tau = model::acting_wrench(*vehicle_, felt);
    } else {
      motion.tau = sample.force;
    }
  }
  std::optional<RowBlock> block = regressor_.step(motion);
  if (track_ && (!sample.valid || regressor_.took())) track_->step(sample);
  if (block && track_ && !track_->extend(*block, regressor_.average(), regressor_.derivative())) return std::nullopt;
  return block;
}

void Identifier::use(const EffectSample& sample) {
  keep(sample);
  const std::optional<RowBlock> block = rows_of(sample);
  if (!block) return;
  // The residual is that of the model published before: nothing is explained by having been seen.
  const ParameterVector known = estimator_.projected();
  Residual residual;
  residual.utime = block->utime;
  for (const Row& row : block->view()) residual.wrench(row.axis) = row.y - row.h.dot(known);
  obey(block->end);
  estimator_.step(block->view());
  remember(*block);
  model_utime_ = block->end;
  weigh(block->end);
  output_.residuals.push_back(residual);
  output_.blocks.push_back(*block);
  output_.models.push_back(model());
  output_.bends.push_back(bend());
}

ModelEstimate Identifier::model() const {
  RecursiveReport report = estimator_.report();
  compensate(report);
  doubt_unmoved(report);
  if (misfit_.any()) report.covariance += misfit_.bend(estimator_.covariance());
  add_systematic(report);
  ModelEstimate estimate;
  estimate.utime = model_utime_;
  estimate.updates = estimator_.state().updates;
  estimate.parameters.reserve(parameters_.size());
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    estimate.parameters.push_back({.name = std::string{name(parameters_[i])},
                                   .value = report.estimate(k),
                                   .std = report.sigma(k),
                                   .unit = std::string{unit(parameters_[i])}});
  }
  add_metrics(estimate, report);
  add_effect(estimate, report);
  return estimate;
}

void Identifier::reset() {
  regressor_.reset();
  track_.reset();
  estimator_ = RecursiveEstimator{estimator_settings(nullptr)};
  rankings_.clear();
  kept_.clear();
  leader_ = {};
  in_a_row_ = without_ = 0;
  stands_for_ = -1;
  origin_ = 0;
  voltage_ = 0.0;
  input_ = InputKind::kUnknown;
  aligner_.reset();
  model_utime_ = 0;
  recent_ = {};
  misfit_ = Misfit{estimator_.size()};
  wishes_.clear();
  frozen_.clear();
  output_ = Output{};
}

int Identifier::column(std::string_view parameter) const {
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (name(parameters_[i]) == parameter) return static_cast<int>(i);
  }
  return -1;
}

RecursiveSettings Identifier::estimator_settings(const model::ActiveEffect* effect) const {
  RecursiveSettings s = recursive_settings(settings_, *vehicle_);
  if (effect == nullptr) return s;
  const Eigen::Index base = s.mean.size();
  const auto parameters = model::parameters_of(*effect->effect, effect->variant, *vehicle_);
  const std::vector<std::size_t> sought = effect->effect->sought(effect->variant);
  s.mean.conservativeResize(base + static_cast<Eigen::Index>(sought.size()));
  s.sigma.conservativeResize(s.mean.size());
  Eigen::Index k = base;
  for (const std::size_t i : sought) {
    s.mean(k) = effect->theta[i];
    s.sigma(k) = parameters[i].sigma;
    s.signs[static_cast<std::size_t>(k)] =
        static_cast<std::int8_t>(parameters[i].low == 0.0 ? 1 : (parameters[i].high == 0.0 ? -1 : 0));
    ++k;
  }
  return s;
}

bool Identifier::freeze(std::string_view parameter) {
  const int i = column(parameter);
  if (i >= 0) estimator_.freeze(i);
  return i >= 0;
}

bool Identifier::resume(std::string_view parameter) {
  const int i = column(parameter);
  if (i >= 0) estimator_.resume(i);
  return i >= 0;
}

}  // namespace fathom::identification

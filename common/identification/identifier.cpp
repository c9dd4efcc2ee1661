// Alignment of the two streams by message time; the mathematics is in the regressor and the estimator.
#include "common/identification/identifier.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/base/error.hpp"

namespace fathom::identification {
namespace {

constexpr double kInputHistory = 5.0;  // s kept before the newest input: far more than channels lag each other

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
  s.parameters = columns_of(vehicle);
  return s;
}

RecursiveSettings recursive_settings(const IdentifierSettings& settings, const model::Vehicle& vehicle) {
  const std::vector<model::BaseParameter> columns = columns_of(vehicle);
  const auto n = static_cast<Eigen::Index>(columns.size());
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
    s.signs[i] = static_cast<std::int8_t>(model::sign_constraint(columns[i]));
    if (settings.buoyant && columns[i] == model::BaseParameter::W_B) s.signs[i] = -1;
  }
  if (settings.memory > 0.0) s.forgetting = std::exp(-settings.stride / settings.memory);
  return s;
}

}  // namespace

Identifier::Identifier(const IdentifierSettings& settings, const model::Vehicle& vehicle)
    : settings_{settings},
      allocation_{vehicle.allocation},
      parameters_{columns_of(vehicle)},
      regressor_{integral_settings(settings, vehicle)},
      estimator_{recursive_settings(settings, vehicle)} {}

const Identifier::Output& Identifier::step(const StateEstimate& state) {
  output_.models.clear();
  output_.residuals.clear();
  if (last_state_ && state.utime <= *last_state_) {
    reject("late");
    return output_;
  }
  last_state_ = state.utime;
  MotionSample sample;
  sample.utime = state.utime;
  sample.valid = state.valid;
  if (!state.valid) reject("state invalid");
  if (sample.valid && !(state.nu.allFinite() && state.q_WB.coeffs().allFinite())) {
    reject("not finite");
    sample.valid = false;
  }
  if (sample.valid) {
    sample.nu = state.nu;
    sample.down_B = state.q_WB.conjugate() * Eigen::Vector3d::UnitZ();
  }
  pending_.push_back(sample);
  release();
  return output_;
}

const Identifier::Output& Identifier::step(const Thrusters& thrusters) {
  output_.models.clear();
  output_.residuals.clear();
  Input input;
  input.utime = thrusters.utime;
  const auto actuators = static_cast<Eigen::Index>(thrusters.force.size());
  if (actuators > 0 && actuators == allocation_.cols()) {
    input.tau = allocation_ * Eigen::Map<const Eigen::VectorXd>(thrusters.force.data(), actuators);
  } else if (thrusters.has_tau) {
    input.tau = Eigen::Map<const Vector6d>(thrusters.tau.data());
  } else {
    reject("no force");
    return output_;
  }
  if (!input.tau.allFinite()) {
    reject("not finite");
  } else if (!inputs_.empty() && input.utime <= inputs_.back().utime) {
    reject("late");
  } else {
    inputs_.push_back(input);
    release();
  }
  return output_;
}

// A state's fate depends on message times alone: it is used when it lies between two inputs no further apart than
// max_input_gap. While no input at or after it is here, it waits, until the newest state says that one can only come
// too late: with channels lagging each other by max_skew at most, every input up to max_skew before that state has
// arrived.
void Identifier::release() {
  std::size_t done = 0;
  for (; done < pending_.size(); ++done) {
    MotionSample& sample = pending_[done];
    const bool covered = !inputs_.empty() && inputs_.back().utime >= sample.utime;
    if (!covered) {
      const bool settled = seconds_between(sample.utime, *last_state_) > settings_.max_skew;
      const bool too_far = inputs_.empty() || seconds_between(inputs_.back().utime, *last_state_) >
                                                  settings_.max_input_gap + settings_.max_skew;
      if (!settled || !too_far) break;
    }
    if (sample.valid) {
      const std::optional<Vector6d> tau = covered ? input_at(sample.utime) : std::nullopt;
      if (tau) sample.tau = *tau;
      if (!tau) reject("no input");
      sample.valid = tau.has_value();
    }
    use(sample);
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(done));
  if (inputs_.size() < 2) return;
  std::size_t old = 0;
  while (old + 2 < inputs_.size() && seconds_between(inputs_[old + 1].utime, inputs_.back().utime) > kInputHistory &&
         (pending_.empty() || inputs_[old + 1].utime < pending_.front().utime)) {
    ++old;
  }
  // Seldom and many at once, since this moves what is kept.
  if (2 * old > inputs_.size()) inputs_.erase(inputs_.begin(), inputs_.begin() + static_cast<std::ptrdiff_t>(old));
}

std::optional<Vector6d> Identifier::input_at(Utime utime) const {
  const auto after = std::lower_bound(inputs_.begin(), inputs_.end(), utime,
                                      [](const Input& input, Utime time) { return input.utime < time; });
  if (after == inputs_.end()) return std::nullopt;
  if (after->utime == utime) return after->tau;
  if (after == inputs_.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const double gap = seconds_between(before->utime, after->utime);
  if (gap > settings_.max_input_gap) return std::nullopt;
  if (!settings_.interpolate_input) return before->tau;
  return Vector6d{before->tau + (seconds_between(before->utime, utime) / gap) * (after->tau - before->tau)};
}

void Identifier::use(const MotionSample& sample) {
  const std::optional<RowBlock> block = regressor_.step(sample);
  if (!block) return;
  // The residual is that of the model published before: nothing is explained by having been seen.
  const ParameterVector known = estimator_.projected();
  Residual residual;
  residual.utime = block->utime;
  for (const Row& row : block->view()) residual.wrench(row.axis) = row.y - row.h.dot(known);
  estimator_.step(block->view());
  model_utime_ = block->end;
  output_.residuals.push_back(residual);
  output_.models.push_back(model());
}

ModelEstimate Identifier::model() const {
  const RecursiveReport report = estimator_.report();
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
  return estimate;
}

void Identifier::reset() {
  regressor_.reset();
  estimator_.reset();
  pending_.clear();
  inputs_.clear();
  last_state_.reset();
  model_utime_ = 0;
  output_ = Output{};
}

int Identifier::column(std::string_view parameter) const {
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (name(parameters_[i]) == parameter) return static_cast<int>(i);
  }
  return -1;
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

#include "common/model/rollout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/rollout_steps.hpp"

namespace fathom::model {
namespace {

constexpr double kLongestLatency = 2.0;  // s of samples that say what a late sensor meant

/// One column of derivatives, seen as a trace.
VelocityView as_trace(VelocityDerivatives& derivatives, Eigen::Index column) {
  constexpr Eigen::Index kColumns = kBaseParameterCount + 6;
  return Eigen::Map<VelocityTrace, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>{
      derivatives.data() + column, 6, derivatives.rows() / 6,
      Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>{6 * kColumns, kColumns}};
}

/// True velocities become what the sensors say.
void as_measured(const Model& model, const Window& window, VelocityTrace& nu) {
  VelocityView seen{nu};
  for (const ActiveEffect& active : model.effects) {
    if (active.effect->measures()) active.effect->measure(seen, window.trial->dt, active.theta, active.variant);
  }
}

}  // namespace

bool rollout(const Model& model, const Window& window, const Vector6d& nu0, VelocityTrace& nu) {
  const bool finished = Rollout{model, *window.trial}.run(window, nu0, nu);
  as_measured(model, window, nu);
  return finished;
}

bool rollout(const Model& model, const Window& window, const Vector6d& nu0, const PoseShift& shift, VelocityTrace& nu,
             PoseTrace& pose) {
  const bool finished = Rollout{model, *window.trial}.run(window, nu0, nu, shift, &pose);
  as_measured(model, window, nu);
  return finished;
}

bool rollout_with_derivatives(const Model& model, const Window& window, const Vector6d& nu0, VelocityTrace& nu,
                              VelocityDerivatives& derivatives) {
  Sensitivity sensitivity{derivatives};
  const bool finished = Rollout{model, *window.trial, &sensitivity}.run(window, nu0, nu);
  VelocityView seen{nu};
  for (const ActiveEffect& active : model.effects) {
    if (!active.effect->measures()) continue;
    active.effect->measure(seen, window.trial->dt, active.theta, active.variant);
    for (Eigen::Index j = 0; j < derivatives.cols(); ++j) {
      VelocityView column = as_trace(derivatives, j);
      active.effect->measure(column, window.trial->dt, active.theta, active.variant);
    }
  }
  return finished;
}

InputSignal input_of(const Model& model, const Trial& trial) {
  return {trial.t.empty() ? 0.0 : trial.t.front(),
          trial.dt,
          trial.input,
          trial.held,
          trial.told,
          {model.input_hold, trial.input_step, trial.input_averaged}};
}

double quickest_decay(const Vehicle& vehicle) {
  const BaseTheta theta = nominal_model(vehicle, true).theta;
  double quickest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 6; ++i) {
    const double damping =
        -theta[index(BaseParameter::X_u) + i] - 2.0 * kTypicalSpeed * theta[index(BaseParameter::X_uu) + i];
    if (vehicle.dof[static_cast<std::size_t>(i)] && theta[i] > 0.0 && damping > 0.0)
      quickest = std::min(quickest, theta[i] / damping);
  }
  return quickest;
}

VelocityTrace true_velocities(const Model& model, const Trial& trial, std::size_t from, std::size_t count) {
  VelocityTrace nu(6, static_cast<Eigen::Index>(count));
  VelocityView view{nu};
  for (std::size_t k = 0; k < count; ++k) nu.col(static_cast<Eigen::Index>(k)) = trial.nu[from + k];
  for (auto active = model.effects.rbegin(); active != model.effects.rend(); ++active) {
    if (active->effect->measures()) active->effect->unmeasure(view, trial.dt, active->theta, active->variant);
  }
  return nu;
}

Vector6d true_velocity(const Model& model, const Trial& trial, std::size_t at) {
  if (std::none_of(model.effects.begin(), model.effects.end(), [](const auto& a) { return a.effect->measures(); })) {
    return trial.nu[at];
  }
  const auto samples = static_cast<std::size_t>(std::ceil(kLongestLatency / trial.dt)) + 2;
  return true_velocities(model, trial, at, std::min(samples, trial.size() - at)).col(0);
}

}  // namespace fathom::model

#include "common/model/rollout.hpp"

#include "common/model/rollout_steps.hpp"

namespace fathom::model {

bool rollout(const Model& model, const Window& window, const Vector6d& nu0, VelocityTrace& nu) {
  return Rollout{model, *window.trial}.run(window, nu0, nu);
}

bool rollout_with_derivatives(const Model& model, const Window& window, const Vector6d& nu0, VelocityTrace& nu,
                              VelocityDerivatives& derivatives) {
  Sensitivity sensitivity{derivatives};
  return Rollout{model, *window.trial, &sensitivity}.run(window, nu0, nu);
}

}  // namespace fathom::model

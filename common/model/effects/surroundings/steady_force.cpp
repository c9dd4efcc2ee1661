// Physics: something pulls with the same force in one level direction of the world, wherever the vehicle is and however
// it moves and turns: a taut line to far away, a moored craft alongside, a steady wind: w = R_WB^T (F_N, F_E, 0). Its
// vertical part is the base model's W-B. Source: the definition of a constant force. Ignores: change in time, a moment
// about Bo. Revealed by hovering on several headings, and by the same speeds with it and against it. Confused with
// current, whose push follows the drag (nothing more than a force while the vehicle moves slowly), with tether_tension
// over a small part of the tether's length, and with asymmetric_drag on one heading; for that, asked
// of craft alone whose file states rudders, fins, propellers or windage (of others the tether stands for it).
#include <algorithm>
#include <array>

#include "common/model/speed_products.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kSteadyForceParameters{
    EffectParameter{.name = "F_N", .unit = "N", .sigma = 5.0, .low = -1e5, .high = 1e5},
    EffectParameter{.name = "F_E", .unit = "N", .sigma = 5.0, .low = -1e5, .high = 1e5}};

class FixedInWorld final : public Form {
 public:
  FormName name(const Scene& scene) const override {
    return when(lives_by_flow(*scene.vehicle) && scene.attitude && scene.velocity &&
                (scene.vehicle->dof[0] || scene.vehicle->dof[1]));
  }
  Starts starts(const Scene& scene) const override {
    const double force = 0.05 * std::max(scene.tau_rms.head<2>().norm(), 1e-2);
    return {{force, force}};
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    load.wrench.head<3>() += motion.R_WB.transpose() * Eigen::Vector3d(theta[0], theta[1], 0.0);
  }
};

}  // namespace

const Effect& steady_force() {
  static const Effect kEffect{
      {.name = "steady_force",
       .sentence = "A steady force pulls in one direction of the world.",
       .revealed_by = "hovering on several headings, and the same speeds with the force and against it",
       .stage = Stage::kBody,
       .amplitudes = 2,
       .feels_motion = false},
      kSteadyForceParameters,
      forms(FixedInWorld{})};
  return kEffect;
}

}  // namespace fathom::model::effects

// Physics: one thruster gives more or less than its curve says (damage, weed, a swapped propeller): f_i = (1 + g)
// f_c,i. Source: f = B K u with a diagonal K of which one number is off (Fossen 2011, sec. 12.3). Ignores: change over
// time (thruster_failure). Revealed by motions that load the thrusters unequally: its axes couple. Confused with a
// common gain error, which the masses and drag absorb whole, and with cross_coupling.
#include <array>

#include "common/model/effect.hpp"
#include "common/model/one_of_many.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrusterGainParameters{EffectParameter{"gain_change", "", 0.2, -1.2, 3.0}};

class OneOff final : public OfThruster {
 public:
  using OfThruster::OfThruster;
  FormName name(const Scene& scene) const override {
    const auto& thrusters = scene.vehicle->thrusters;
    if (scene.input_is_wrench || thrusters.size() <= 1 || !exists(scene)) return {};
    return thrusters[place()].name;
  }

  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (thruster_ < motion.force.size()) motion.force[thruster_] *= 1.0 + theta[0];
  }
};

}  // namespace

const Effect& thruster_gain() {
  static const Effect kEffect{{.name = "thruster_gain",
                               .sentence = "One thruster gives more or less force than it should.",
                               .revealed_by = "sway, surge and yaw at constant thrust: the odd one turns the vehicle",
                               .finding = "{thruster} gives {gain_change more} than the file says",
                               .stage = Stage::kThrust,
                               .forms_coexist = true,
                               .feels_motion = false},
                              kThrusterGainParameters,
                              form_per_thruster<OneOff>()};
  return kEffect;
}

}  // namespace fathom::model::effects

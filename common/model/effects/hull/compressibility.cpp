// Physics: pressure squeezes hull, foam and trapped air, so buoyancy falls with depth; a vehicle stiffer than water
// gains buoyancy instead (Fossen 2011, sec. 4.1.2 takes B as constant). Linear: weight minus buoyancy grows by s per
// metre of depth, w = s z down_B; the constant part is the base model's W-B. Ignores: the hull's moment, air that
// dissolves, temperature. Revealed by slow dives over the whole range of depth, with pauses. Confused with
// bottom_effect (which bends), layered_water whose edge is wide, a tether's vertical pull, and W-B when the depth hardly changes.
#include <algorithm>
#include <array>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kCompressibilityParameters{EffectParameter{"weight_per_depth", "N/m", 2.0, -200.0, 200.0}};
constexpr double kCompressibilitySmallestRange = 0.05;  // m of depth

class WeightByDepth final : public Form {
 public:
  FormName name(const Scene& scene) const override {
    return when(scene.position && scene.vehicle->dof[2] &&
                scene.p_high.z() - scene.p_low.z() > kCompressibilitySmallestRange);
  }
  Starts starts(const Scene& scene) const override {
    const double range = std::max(scene.p_high.z() - scene.p_low.z(), kCompressibilitySmallestRange);
    return {{0.1 * std::max(scene.tau_rms[2], 1e-3) / range}};
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    load.wrench.head<3>() += theta[0] * motion.p_WB.z() * motion.R_WB.row(2).transpose();
  }
};

}  // namespace

const Effect& compressibility() {
  static const Effect kEffect{{.name = "compressibility",
                               .sentence = "Buoyancy changes with depth.",
                               .revealed_by = "slow dives over the whole depth, with pauses",
                               .stage = Stage::kBody,
                               .feels_motion = false,
                               .feels_place = true},
                              kCompressibilityParameters,
                              forms(WeightByDepth{})};
  return kEffect;
}

}  // namespace fathom::model::effects

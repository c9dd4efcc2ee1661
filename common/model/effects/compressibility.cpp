// Physics: pressure squeezes hull, foam and trapped air, so buoyancy falls with depth; a vehicle stiffer than water
// gains buoyancy instead (Fossen 2011, sec. 4.1.2 takes B as constant). Linear: weight minus buoyancy grows by s per
// metre of depth, w = s z down_B; the constant part is the base model's W-B. Ignores: the hull's moment, air that
// dissolves, temperature. Revealed by slow dives over the whole range of depth, with pauses. Confused with
// bottom_effect (which bends), a tether's vertical pull, and W-B when the depth hardly changes.
#include <algorithm>
#include <array>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kCompressibilityParameters{EffectParameter{"weight_per_depth", "N/m", 2.0, -200.0, 200.0}};
constexpr double kCompressibilitySmallestRange = 0.05;  // m of depth

class Compressibility final : public Effect {
 public:
  std::string_view name() const override { return "compressibility"; }
  std::string_view sentence() const override { return "Buoyancy changes with depth."; }
  std::string_view revealed_by() const override { return "slow dives over the whole depth, with pauses"; }
  std::span<const EffectParameter> parameters() const override { return kCompressibilityParameters; }
  bool feels_motion() const override { return false; }
  bool feels_place() const override { return true; }
  std::vector<std::string> variants(const Scene& scene) const override {
    const bool seen =
        scene.position && scene.vehicle->dof[2] && scene.p_high.z() - scene.p_low.z() > kCompressibilitySmallestRange;
    return seen ? std::vector<std::string>{""} : std::vector<std::string>{};
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int) const override {
    const double range = std::max(scene.p_high.z() - scene.p_low.z(), kCompressibilitySmallestRange);
    return {{0.1 * std::max(scene.tau_rms[2], 1e-3) / range}};
  }

  void load(const Motion& motion, EffectTheta theta, int, Load& load) const override {
    load.wrench.head<3>() += theta[0] * motion.p_WB.z() * motion.R_WB.row(2).transpose();
  }
};

}  // namespace

const Effect& compressibility() {
  static const Compressibility kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

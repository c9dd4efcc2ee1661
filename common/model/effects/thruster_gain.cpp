// Physics: one thruster gives more or less than its curve says (damage, weed, a swapped propeller): f_i = (1 + g)
// f_c,i. Source: f = B K u with a diagonal K of which one number is off (Fossen 2011, sec. 12.3). Ignores: change over
// time (thruster_failure). Revealed by motions that load the thrusters unequally: its axes couple. Confused with a
// common gain error, which the masses and drag absorb whole, and with cross_coupling.
#include <array>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrusterGainParameters{EffectParameter{"gain_change", "", 0.2, -1.2, 3.0}};

class ThrusterGain final : public Effect {
 public:
  std::string_view name() const override { return "thruster_gain"; }
  std::string_view sentence() const override { return "One thruster gives more or less force than it should."; }
  std::string_view revealed_by() const override {
    return "sway, surge and yaw at constant thrust: the odd one turns the vehicle";
  }
  std::span<const EffectParameter> parameters() const override { return kThrusterGainParameters; }
  bool feels_motion() const override { return false; }
  bool variants_matter() const override { return true; }
  std::vector<std::string> variants(const Scene& scene) const override {
    if (scene.input_is_wrench) return {};
    std::vector<std::string> names;
    for (const Thruster& thruster : scene.vehicle->thrusters) names.push_back(thruster.name);
    return names.size() > 1 ? names : std::vector<std::string>{};
  }
  /// One that gives nothing: beside what it was thought to give, masses and drag have gone so far astray that no slope
  /// leads here.
  std::vector<std::vector<double>> far_starts(const Scene&, int) const override { return {{-1.0}}; }

  void feel(Motion& motion, EffectTheta theta, int variant, std::span<const double>) const override {
    if (variant < motion.force.size()) motion.force[variant] *= 1.0 + theta[0];
  }
};

}  // namespace

const Effect& thruster_gain() {
  static const ThrusterGain kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

// Physics: propellers give less thrust astern than the same command gives ahead: f = (1 + a) f_c for f_c < 0. Source:
// makers' thrust curves, whose two branches differ. Ignores: that the ratio may differ between thrusters. Revealed by
// motion in both directions at equal command. Confused with asymmetric_drag (which acts on the hull, so it follows
// speed, not thrust) and steady pulls.
#include <array>

#include "common/model/effect.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrustAsymmetryParameters{EffectParameter{"reverse_change", "", 0.2, -0.95, 3.0}};

class ThrustAsymmetry final : public Effect {
 public:
  std::string_view name() const override { return "thrust_asymmetry"; }
  std::string_view sentence() const override { return "Thrusters push differently in reverse than ahead."; }
  std::string_view revealed_by() const override { return "equal thrust in both directions, for several seconds each"; }
  std::span<const EffectParameter> parameters() const override { return kThrustAsymmetryParameters; }
  bool feels_motion() const override { return false; }
  bool order_matters() const override { return true; }

  void feel(Motion& motion, EffectTheta theta, int, std::span<const double>) const override {
    for (double& force : motion.force) {
      if (force < 0.0) force *= 1.0 + theta[0];
    }
  }
};

}  // namespace

const Effect& thrust_asymmetry() {
  static const ThrustAsymmetry kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

// Physics: propellers give less thrust astern than the same command gives ahead: f = (1 + a) f_c for f_c < 0. Source:
// makers' thrust curves, whose two branches differ. Ignores: that the ratio may differ between thrusters. Revealed by
// motion in both directions at equal command. Confused with asymmetric_drag (which acts on the hull, so it follows
// speed, not thrust) and steady pulls.
#include <array>

#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrustAsymmetryParameters{EffectParameter{"reverse_change", "", 0.2, -0.95, 3.0}};

class WeakerAstern final : public Form {
 public:
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) {
      if (motion.force[i] < 0.0 && !is_no_propeller(motion, i)) motion.force[i] *= 1.0 + theta[0];
    }
  }
};

}  // namespace

const Effect& thrust_asymmetry() {
  static const Effect kEffect{{.name = "thrust_asymmetry",
                               .sentence = "Thrusters push differently in reverse than ahead.",
                               .revealed_by = "equal thrust in both directions, for several seconds each",
                               .finding = "Thrusters in reverse give {reverse_change more} than ahead",
                               .stage = Stage::kThrust,
                               .feels_motion = false},
                              kThrustAsymmetryParameters,
                              forms(WeakerAstern{})};
  return kEffect;
}

}  // namespace fathom::model::effects

// Physics: at a moment the vehicle takes up or drops a payload at Bo: mass m_P (in water, its added mass included) and
// net weight w_P = m_P g minus its buoyancy, which are independent of each other. With the smooth step s of 1 s:
//   (M + s diag(m_P, m_P, m_P, 0, 0, 0)) nu_dot = ... - s w x m_P v + s w_P down_B
// Source: Newton-Euler about Bo with a point mass there (Fossen 2011, sec. 3.3). Ignores: an arm (moment and inertia of
// rotation), the momentum exchanged at that moment, that several runs seldom change at the same time of the run.
// Revealed by hovering and by the same steps of thrust early and late. Confused with battery_sag and W-B when the
// change comes early or late in the data, with thruster_failure of a vertical thruster.
#include <algorithm>
#include <array>

#include "common/model/effect.hpp"
#include "common/model/onset.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kPayloadChangeParameters{EffectParameter{.name = "mass",
                                                              .unit = "kg",
                                                              .sigma = 2.0,
                                                              .low = -1000.0,
                                                              .high = 1000.0,
                                                              .drawn_within = DrawnWithin::kVehicleMass},
                                              EffectParameter{"weight", "N", 5.0, -1000.0, 1000.0}, kOnsetParameter};
constexpr int kMoments = 10;
constexpr double kFallbackMass = 10.0;  // kg

class PayloadAtOrigin final : public Form {
 public:
  FormName name(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    return when((dof[0] || dof[1] || dof[2]) && scene.velocity && scene.t_high - scene.t_low > kOnsetDuration);
  }
  Starts starts(const Scene& scene) const override {
    const double mass = scene.vehicle->mass > 0.0 ? scene.vehicle->mass : kFallbackMass;
    Starts starts;
    for (const double moment : onset_starts(scene.t_low, scene.t_high, kMoments)) {
      const double onset = std::max(moment, 0.0);
      if (scene.vehicle->dof[2]) starts.push_back({0.0, 0.1 * std::max(scene.tau_rms[2], 0.1), onset});
      starts.push_back({0.1 * mass, 0.0, onset});
    }
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const double share = onset_share(motion.t, theta[2]);
    if (share == 0.0) return;
    load.wrench.head<3>() += share * theta[1] * motion.R_WB.row(2).transpose();
    if (theta[0] != 0.0) load.add_mass(share * theta[0], motion.nu);
  }
};

}  // namespace

const Effect& payload_change() {
  static const Effect kEffect{{.name = "payload_change",
                               .sentence = "The vehicle gains or loses mass and weight at some moment.",
                               .revealed_by = "hovering and the same steps of thrust, early and late",
                               .stage = Stage::kBody,
                               .amplitudes = 2,
                               .feels_motion = false},
                              kPayloadChangeParameters,
                              forms(PayloadAtOrigin{})};
  return kEffect;
}

}  // namespace fathom::model::effects

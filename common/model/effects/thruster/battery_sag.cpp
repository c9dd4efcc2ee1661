// Physics: thrust at a given command falls with the battery's voltage: f = f_c (V / V_ref)^k, k between 1 and 2 for an
// open propeller on a DC motor (bounds wider: a controller below its voltage loses more); where no voltage is logged,
// or it does not change, f = f_c (1 - s t / 300 s) with t the time in the run. Source: a DC motor at a given duty turns
// as fast as its voltage lets it, and thrust goes with the square of that speed (Fossen 2011, eq. 12.236 without
// advance). Ignores: load-dependent sag within the thruster's own cable. Revealed by the same manoeuvre early and late.
// Confused with payload change and, in one short run, with drag.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kBatterySagParameters{EffectParameter{"sensitivity", "", 1.0, -1.0, 4.0}};
constexpr double kFallbackVoltage = 16.0;  // V: any constant serves, gain errors hide in the base parameters
constexpr double kTimeScale = 300.0;  // s: the bound then allows a battery that is empty after a minute and a quarter
constexpr double kSmallestRange = 0.003;  // of the voltage: less says nothing
constexpr double kSmallestShare = 0.05;   // of the thrust, which cannot turn round

void scale_propellers(Motion& motion, double factor) {
  for (Eigen::Index i = 0; i < motion.force.size(); ++i) {
    if (!is_no_propeller(motion, i)) motion.force[i] *= factor;
  }
}

bool useful(const Scene& scene) { return scene.voltage && scene.voltage_range > kSmallestRange * scene.mean_voltage; }

class PowerOfVoltage final : public Form {
 public:
  FormName name(const Scene& scene) const override { return when(useful(scene), "voltage exponent"); }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (motion.voltage <= 0.0) return;
    const double reference = motion.vehicle->nominal_voltage > 0.0 ? motion.vehicle->nominal_voltage : kFallbackVoltage;
    scale_propellers(motion, std::pow(motion.voltage / reference, theta[0]));
  }
};

class LossInTime final : public Form {
 public:
  FormName name(const Scene& scene) const override { return when(!useful(scene), "loss per 300 s"); }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    scale_propellers(motion, std::max(1.0 - theta[0] * motion.t / kTimeScale, kSmallestShare));
  }
};

}  // namespace

const Effect& battery_sag() {
  static const Effect kEffect{{.name = "battery_sag",
                               .sentence = "Thrust changes as the battery's voltage changes.",
                               .revealed_by = "the same manoeuvre on a full and on an emptied battery",
                               .stage = Stage::kThrust,
                               .feels_motion = false},
                              kBatterySagParameters,
                              forms(PowerOfVoltage{}, LossInTime{})};
  return kEffect;
}

}  // namespace fathom::model::effects

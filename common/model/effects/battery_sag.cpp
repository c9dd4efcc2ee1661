// Physics: thrust at a given command falls with the battery's voltage: f = f_c (V / V_ref)^k, k between 1 and 2 for an
// open propeller on a DC motor (bounds a little wider); without a voltage log, f = f_c (1 - s t) with t the time in the
// run. Ignores: load-dependent sag within the thruster's own cable. Revealed by the same manoeuvre early and late.
// Confused with payload change and, in one short run, with drag.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

// One number with two meanings would hide its unit: the time form is scaled to "share lost per 1000 s".
constexpr std::array kParameters{EffectParameter{"sensitivity", "", 1.0, -1.0, 2.5}};
constexpr double kTimeScale = 1000.0;  // s

class BatterySag final : public Effect {
 public:
  std::string_view name() const override { return "battery_sag"; }
  std::string_view sentence() const override { return "Thrust changes as the battery's voltage changes."; }
  std::string_view revealed_by() const override { return "the same manoeuvre on a full and on an emptied battery"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  bool feels_motion() const override { return false; }
  std::vector<std::string> variants(const Scene& scene) const override {
    return {scene.voltage ? "voltage exponent" : "loss per 1000 s"};
  }

  void feel(Motion& motion, EffectTheta theta, int, std::span<const double>) const override {
    double factor = 0.0;
    if (motion.voltage > 0.0) {
      const double reference =
          motion.vehicle->nominal_voltage > 0.0 ? motion.vehicle->nominal_voltage : kFallbackVoltage;
      factor = std::pow(motion.voltage / reference, theta[0]);
    } else {
      factor = std::max(1.0 - theta[0] * motion.t / kTimeScale, 0.05);
    }
    motion.force *= factor;
  }

 private:
  static constexpr double kFallbackVoltage = 16.0;  // V: any constant serves, gain errors hide in the base parameters
};

}  // namespace

const Effect& battery_sag() {
  static const BatterySag kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

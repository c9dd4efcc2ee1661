// Physics: propeller and water need time to reach the new thrust: first order, T f_dot = f_c - f (Fossen 2011,
// sec. 12.3). Ignores: that the time constant shrinks with shaft speed (Yoerger 1990). Revealed by reversals at
// frequencies near 1/T. Confused with thruster_delay and, over a narrow band, with added mass.
#include <array>
#include <cmath>

#include "common/model/effect.hpp"
#include "common/model/effect_size.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"time_constant", "s", 0.15, 0.0, 3.0, 0.0, true}};

class ThrusterLag final : public Effect {
 public:
  std::string_view name() const override { return "thruster_lag"; }
  std::string_view sentence() const override { return "Thrust builds up gradually after each change of command."; }
  std::string_view revealed_by() const override { return "steps and a sweep of thrust up to about 2 Hz"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  bool feels_motion() const override { return false; }
  std::vector<std::vector<double>> starts(const Scene& scene, int) const override {
    const double slower = size_factor(*scene.vehicle, "s");
    return {{0.08 * slower}, {0.3 * slower}, {0.9 * slower}};
  }
  int state_size(const Vehicle&, int actuators) const override { return actuators; }
  double run_in(EffectTheta theta) const override { return run_in_for(theta[0]); }

  void settle(const Motion& motion, EffectTheta, std::span<double> z) const override {
    for (std::size_t i = 0; i < z.size(); ++i) z[i] = motion.force[static_cast<Eigen::Index>(i)];
  }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
    const double share = theta[0] > 0.0 ? -std::expm1(-dt / theta[0]) : 1.0;
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += share * (motion.force[static_cast<Eigen::Index>(i)] - z[i]);
  }
  void feel(Motion& motion, EffectTheta theta, int, std::span<const double> z) const override {
    if (theta[0] <= 0.0) return;
    for (std::size_t i = 0; i < z.size(); ++i) motion.force[static_cast<Eigen::Index>(i)] = z[i];
  }
};

}  // namespace

const Effect& thruster_lag() {
  static const ThrusterLag kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

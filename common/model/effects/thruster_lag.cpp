// Physics: propeller and water need time to reach the new thrust: first order, T f_dot = f_c - f (Fossen 2011,
// sec. 12.3). Forms: for all thrusters alike; T + dT for those that push up and down, which are often of another make
// (thruster_kinds.hpp); or it is the shaft that needs time, whose speed thrust goes with the square of: T n_dot = n_c -
// n, f = n |n| (a regulated motor; Blanke et al. 2000). Thrust then starts slowly, and falls quickly when the shaft
// stops; a reversal lingers at nothing; or second order: motor and water one after the other, T each (Healey et al.
// 1995), which starts with no slope. Ignores: that the time constant shrinks with shaft speed (Yoerger 1990), two
// refinements at once. Revealed by reversals at frequencies near 1/T, the law by steps up and down. Confused with
// thruster_delay and, over a narrow band, with added mass.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/effect_size.hpp"
#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"time_constant", "s", 0.15, 0.0, 3.0, 0.0, true},
                                 EffectParameter{"vertical_longer", "s", 0.15, -3.0, 3.0}};
enum Form { kAlike, kTwoKinds, kShaft, kSecondOrder };

/// s. What two kinds differ by is zero in the other forms.
double of_vertical(EffectTheta theta) { return time_of_vertical(theta[0], theta[1]); }
double share_in(double dt, double time_constant) {
  return time_constant > 0.0 ? -std::expm1(-dt / time_constant) : 1.0;
}
/// Shaft speed of a force, up to a factor that plays no part.
double shaft(double force) { return std::copysign(std::sqrt(std::abs(force)), force); }

class ThrusterLag final : public Effect {
 public:
  std::string_view name() const override { return "thruster_lag"; }
  std::string_view sentence() const override { return "Thrust builds up gradually after each change of command."; }
  std::string_view revealed_by() const override { return "steps and a sweep of thrust up to about 2 Hz"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  bool feels_motion() const override { return false; }
  bool takes_part(int variant, std::size_t number) const override { return number == 0 || variant == kTwoKinds; }
  std::vector<std::string> variants(const Scene& scene) const override {
    // Of a wrench nobody knows which shafts made it.
    return {"", has_both_kinds(scene) ? "vertical thrusters apart" : "-", scene.input_is_wrench ? "-" : "shaft speed",
            "second order"};
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const double slower = size_factor(*scene.vehicle, "s");
    if (variant == kTwoKinds) return {{0.1 * slower, 0.3 * slower}, {0.4 * slower, -0.3 * slower}};
    const double each = variant == kSecondOrder ? 0.5 : 1.0;
    return {{0.08 * each * slower, 0.0}, {0.3 * each * slower, 0.0}, {0.9 * each * slower, 0.0}};
  }
  /// Thrust and, behind it, shaft speed and thrust that follows the first, of each: advance() is not told which of them
  /// the form asks for. The last takes longer to forget.
  int state_size(const Vehicle&, int actuators) const override { return 3 * actuators; }
  double run_in(EffectTheta theta) const override { return run_in_for(1.5 * std::max(theta[0], of_vertical(theta))); }

  void settle(const Motion& motion, EffectTheta, std::span<double> z) const override {
    const std::size_t n = z.size() / 3;
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = motion.force[static_cast<Eigen::Index>(i)];
      z[n + i] = shaft(z[i]);
      z[2 * n + i] = z[i];
    }
  }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
    const std::size_t n = z.size() / 3;
    const bool apart = of_vertical(theta) != theta[0];
    const double share = share_in(dt, theta[0]), of_others = apart ? share_in(dt, of_vertical(theta)) : share;
    const double passed_on = theta[0] > 0.0 ? dt / theta[0] * (1.0 - share) : 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const bool vertical = apart && is_vertical(*motion.vehicle, k, motion.force.size());
      // Exact for a force that is held.
      z[2 * n + i] += share * (motion.force[k] - z[2 * n + i]) + passed_on * (z[i] - motion.force[k]);
      z[i] += (vertical ? of_others : share) * (motion.force[k] - z[i]);
      z[n + i] += share * (shaft(motion.force[k]) - z[n + i]);
    }
  }
  void feel(Motion& motion, EffectTheta theta, int variant, std::span<const double> z) const override {
    const std::size_t n = z.size() / 3;
    if (theta[0] <= 0.0 && of_vertical(theta) <= 0.0) return;
    for (std::size_t i = 0; i < n; ++i) {
      motion.force[static_cast<Eigen::Index>(i)] = variant == kShaft         ? z[n + i] * std::abs(z[n + i])
                                                   : variant == kSecondOrder ? z[2 * n + i]
                                                                             : z[i];
    }
  }
};

}  // namespace

const Effect& thruster_lag() {
  static const ThrusterLag kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

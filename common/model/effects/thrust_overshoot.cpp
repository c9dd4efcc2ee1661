// Physics: a propeller in water at rest pushes harder than one whose own inflow has built up: after a step of command
// the thrust peaks, then sinks to its steady value (Healey et al. 1995; Whitcomb and Yoerger 1999). First order in the
// inflow: f = f_c - k g, T g_dot = f_c - g. The steady thrust is (1 - k) f_c, the first instant's f_c. Forms: all
// thrusters alike, or only those that push sideways (horizontal) or only those that push up (vertical), since a jet's
// fate depends on what it meets. Ignores: that T shrinks with the jet's speed. Revealed by steps held for several T.
// Confused with mass and linear drag together, and with fluid_memory.
#include <array>
#include <cmath>

#include "common/model/decay_share.hpp"
#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrustOvershootParameters{EffectParameter{"share_lost", "", 0.3, 0.0, 0.98},
                                                EffectParameter{"time_constant", "s", 1.0, 0.05, 10.0}};

enum ThrustOvershootForm { kAll, kHorizontal, kVertical };

class ThrustOvershoot final : public Effect {
 public:
  std::string_view name() const override { return "thrust_overshoot"; }
  std::string_view sentence() const override { return "Thrust peaks after each change of command and then fades."; }
  std::string_view revealed_by() const override { return "steps of thrust held for five seconds and more"; }
  std::span<const EffectParameter> parameters() const override { return kThrustOvershootParameters; }
  int amplitudes() const override { return 1; }
  bool feels_motion() const override { return false; }
  std::vector<std::string> variants(const Scene& scene) const override {
    const bool both = has_both_kinds(scene);
    return {"all", both ? "horizontal" : "-", both ? "vertical" : "-"};
  }
  bool variants_matter() const override { return true; }
  std::vector<std::vector<double>> starts(const Scene&, int) const override {
    return {{0.1, 0.3}, {0.1, 1.0}, {0.1, 3.0}};
  }
  std::vector<std::vector<double>> far_starts(const Scene&, int) const override { return {{0.6, 0.8}}; }
  int state_size(const Vehicle&, int actuators) const override { return actuators; }
  double run_in(EffectTheta theta) const override { return run_in_for(theta[1]); }

  void settle(const Motion& motion, EffectTheta, int, std::span<double> z) const override {
    for (std::size_t i = 0; i < z.size(); ++i) z[i] = motion.force[static_cast<Eigen::Index>(i)];
  }
  void advance(const Motion& motion, EffectTheta theta, int, double dt, std::span<double> z) const override {
    thread_local DecayShare decay;
    const double share = decay(dt, theta[1]);
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += share * (motion.force[static_cast<Eigen::Index>(i)] - z[i]);
  }
  void feel(Motion& motion, EffectTheta theta, int variant, std::span<const double> z) const override {
    for (std::size_t i = 0; i < z.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if (variant != kAll && is_vertical(*motion.vehicle, k, motion.force.size()) != (variant == kVertical)) continue;
      motion.force[k] -= theta[0] * z[i];
    }
  }
};

}  // namespace

const Effect& thrust_overshoot() {
  static const ThrustOvershoot kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

// Physics: a propeller that advances into its own thrust loses some of it. With advance speed u_a along the thrust
// axis, shaft speed n ~ sign(f_c) sqrt|f_c|: bilinear model T = T_nn |n|n - T_nu |n| u_a (Fossen 2011, eq. 12.236),
// thus
//   f = f_c - c sqrt|f_c| u_a  (form "shaft speed"),   or   f = f_c - c |f_c| u_a  (form "thrust": a fixed share per
//   m/s).
// u_a is the water's speed past the thruster, turning of the vehicle included, or ("hull's advance") without that,
// as in sheets that give thrust over the vehicle's speed, and where the hull shields the thruster. With a wrench as
// input the forces X, Y, Z are taken as one thruster each. Ignores: inflow across the axis, cavitation. Revealed by the
// same thrust at rest and at full speed. Confused with linear drag, which takes over its mean; what remains follows
// thrust times speed.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrustLossParameters{EffectParameter{"coefficient", "N^(1/2)/(m/s)", 1.0, 0.0, 50.0}};
enum ThrustLossForm { kShaftSpeed, kThrust, kShaftSpeedOfHull, kThrustOfHull };
constexpr Eigen::Index kForces = 3;  // of a wrench: moments have no advance speed

class ThrustLoss final : public Effect {
 public:
  std::string_view name() const override { return "thrust_loss"; }
  std::string_view sentence() const override { return "Thrust falls as the vehicle moves along with it."; }
  std::string_view revealed_by() const override { return "equal thrust while hovering and at full speed"; }
  std::span<const EffectParameter> parameters() const override { return kThrustLossParameters; }
  std::string_view unit(int variant, std::size_t) const override {
    return by_shaft(variant) ? kThrustLossParameters[0].unit : "1/(m/s)";
  }
  std::vector<std::string> variants(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    const bool moves = scene.input_is_wrench ? dof[0] || dof[1] || dof[2] : !scene.vehicle->thrusters.empty();
    if (!moves) return {};
    std::vector<std::string> forms{"shaft speed", "thrust"};
    const bool turns = !scene.input_is_wrench && (dof[3] || dof[4] || dof[5]);
    for (const char* form : {"shaft speed, hull's advance", "thrust, hull's advance"}) {
      if (turns) forms.emplace_back(form);
    }
    return forms;
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const double speed = std::max(scene.nu_rms.head<3>().norm(), 0.05);
    const double force = scene.force_rms.size() > 0 ? std::max(scene.force_rms.maxCoeff(), 1e-3) : 1.0;
    return {{0.05 * (by_shaft(variant) ? std::sqrt(force) : 1.0) / speed}};
  }

  void feel(Motion& motion, EffectTheta theta, int variant, std::span<const double>) const override {
    if (theta[0] == 0.0) return;
    const Vector6d nu_r = motion.nu_r();
    const auto& allocation = motion.vehicle->allocation;
    const bool wrench = allocation.cols() != motion.force.size();
    const Eigen::Index speeds = variant >= kShaftSpeedOfHull ? 3 : 6;
    const Eigen::Index count = wrench ? std::min(kForces, motion.force.size()) : motion.force.size();
    for (Eigen::Index i = 0; i < count; ++i) {
      // axis . (v_r + w x p)
      const double advance = wrench ? nu_r[i] : allocation.col(i).head(speeds).dot(nu_r.head(speeds));
      const double size = std::abs(motion.force[i]);
      motion.force[i] -= theta[0] * (by_shaft(variant) ? std::sqrt(size) : size) * advance;
    }
  }

 private:
  static bool by_shaft(int variant) { return variant == kShaftSpeed || variant == kShaftSpeedOfHull; }
};

}  // namespace

const Effect& thrust_loss() {
  static const ThrustLoss kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

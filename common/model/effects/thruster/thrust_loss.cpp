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

#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrustLossParameters{EffectParameter{"coefficient", "N^(1/2)/(m/s)", 1.0, 0.0, 50.0}};
constexpr Eigen::Index kForces = 3;  // of a wrench: moments have no advance speed

/// Loses with the advance speed, with or without what the vehicle's turning adds to it.
class LossByAdvance : public Form {
 public:
  LossByAdvance(const char* name, bool of_hull, std::optional<std::string_view> unit = {})
      : Form{{.unit = unit}}, name_{name}, of_hull_{of_hull} {}
  FormName name(const Scene& scene) const final {
    const auto& dof = scene.vehicle->dof;
    const bool moves = scene.input_is_wrench ? dof[0] || dof[1] || dof[2] : !scene.vehicle->thrusters.empty();
    const bool turns = !scene.input_is_wrench && (dof[3] || dof[4] || dof[5]);
    return when(moves && (turns || !of_hull_), name_);
  }
  Starts starts(const Scene& scene) const final {
    const double speed = std::max(scene.nu_rms.head<3>().norm(), 0.05);
    const double force = scene.force_rms.size() > 0 ? std::max(scene.force_rms.maxCoeff(), 1e-3) : 1.0;
    return {{0.05 * start_scale(force) / speed}};
  }

  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const final {
    if (theta[0] == 0.0) return;
    const Vector6d nu_r = motion.nu_r();
    const auto& allocation = motion.vehicle->allocation;
    const bool wrench = allocation.cols() != motion.force.size();
    const Eigen::Index speeds = of_hull_ ? 3 : 6;
    const Eigen::Index count = wrench ? std::min(kForces, motion.force.size()) : motion.force.size();
    for (Eigen::Index i = 0; i < count; ++i) {
      if (is_no_propeller(motion, i)) continue;
      // axis . (v_r + w x p)
      const double advance = wrench ? nu_r[i] : allocation.col(i).head(speeds).dot(nu_r.head(speeds));
      motion.force[i] -= theta[0] * loses(std::abs(motion.force[i])) * advance;
    }
  }

 protected:
  /// Per unit of the coefficient and of the advance speed, of a force of that size.
  [[nodiscard]] virtual double loses(double size) const = 0;
  /// Coefficient that makes a share of one of it, per 1/(m/s).
  [[nodiscard]] virtual double start_scale(double force) const = 0;

 private:
  const char* name_;
  bool of_hull_;
};

class ByShaftSpeed final : public LossByAdvance {
 public:
  using LossByAdvance::LossByAdvance;

 private:
  double loses(double size) const override { return std::sqrt(size); }
  double start_scale(double force) const override { return std::sqrt(force); }
};

class ByThrust final : public LossByAdvance {
 public:
  ByThrust(const char* name, bool of_hull) : LossByAdvance{name, of_hull, "1/(m/s)"} {}

 private:
  double loses(double size) const override { return size; }
  double start_scale(double) const override { return 1.0; }
};

}  // namespace

const Effect& thrust_loss() {
  static const Effect kEffect{
      {.name = "thrust_loss",
       .sentence = "Thrust falls as the vehicle moves along with it.",
       .revealed_by = "equal thrust while hovering and at full speed",
       .stage = Stage::kWater},
      kThrustLossParameters,
      forms(ByShaftSpeed{"shaft speed", false}, ByThrust{"thrust", false},
            ByShaftSpeed{"shaft speed, hull's advance", true}, ByThrust{"thrust, hull's advance", true})};
  return kEffect;
}

}  // namespace fathom::model::effects

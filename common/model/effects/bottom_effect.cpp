// Physics: near the bottom the water between hull and floor cannot escape freely. Two forms, both falling with the
// inverse square of the gap h = z_b - z (boundary.hpp): `force`, a steady push up (cushion of the thrusters' wash, a >
// 0) or pull down (suction, a < 0), w = -a / h^2 down_B; and `drag`, more of it in all directions, w = -c / h^2 |v_r|
// v_r. The bottom's depth z_b is a number to be found. Ignores: growth of the added mass, slope of the bottom, which
// thruster blows. Revealed by hovering and moving at several heights, one within a hull's length of the floor. Confused
// with compressibility (linear in depth), which it becomes when the floor is far.
#include <algorithm>
#include <array>

#include "common/model/boundary.hpp"
#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"strength", "N m^2", 5.0, -1e4, 1e4},
                                 EffectParameter{"bottom_depth", "m", 20.0}};
constexpr int kForce = 0;
constexpr double kSmallestRange = 0.05;           // m of depth
constexpr std::array kGaps{0.15, 0.4, 1.0, 2.5};  // m below the deepest place

class BottomEffect final : public Effect {
 public:
  std::string_view name() const override { return "bottom_effect"; }
  std::string_view sentence() const override { return "The bottom below is felt when it is near."; }
  std::string_view revealed_by() const override { return "hovering and moving at several heights above the floor"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  int amplitudes() const override { return 1; }
  bool feels_motion() const override { return false; }
  bool feels_place() const override { return true; }
  /// A floor that takes drag away is none.
  bool possible(const Eigen::Vector3d& p_WB, EffectTheta theta, int variant) const override {
    return theta[1] > p_WB.z() && (variant == kForce || theta[0] >= 0.0);
  }
  bool variants_matter() const override { return true; }
  std::string_view unit(int variant, std::size_t number) const override {
    return number == 0 && variant != kForce ? "N m^2/(m/s)^2" : kParameters[number].unit;
  }
  std::vector<std::string> variants(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    if (!scene.position || scene.p_high.z() - scene.p_low.z() <= kSmallestRange) return {};
    return {dof[2] ? "force" : "-", dof[0] || dof[1] || dof[2] ? "drag" : "-"};
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const double range = scene.p_high.z() - scene.p_low.z();
    const double speed = std::max(scene.nu_rms.head<3>().norm(), 1e-2);
    const double force = 0.1 * std::max(scene.tau_rms.head<3>().norm(), 1e-2);
    std::vector<std::vector<double>> starts;
    for (const double gap : kGaps) {
      const double height = gap + 0.25 * range;  // where it should be worth a tenth of the thrust
      starts.push_back({force * height * height / (variant == kForce ? 1.0 : speed * speed), scene.p_high.z() + gap});
    }
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    const double near = theta[0] * proximity(theta[1] - motion.p_WB.z());
    if (variant == kForce) {
      load.wrench.head<3>() -= near * motion.R_WB.row(2).transpose();
    } else {
      const Eigen::Vector3d v_r = motion.nu_r().head<3>();
      load.wrench.head<3>() -= near * v_r.norm() * v_r;
    }
  }
};

}  // namespace

const Effect& bottom_effect() {
  static const BottomEffect kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

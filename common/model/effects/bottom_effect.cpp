// Physics: near the bottom the water between hull and floor cannot escape freely. `force` is a steady push up (cushion
// of the thrusters' wash, a > 0) or pull down (suction, a < 0), w = -a f down_B; `drag`: the hull's own translational
// drag grows by the share c f. Each falls with the inverse square of the gap to the bottom, f = 1 / (z_b - z)^2, or
// exponentially, f = exp((z - z_d) / s), told for the deepest place z_d that was visited (boundary.hpp); or `suction`
// of a hull that passes by, w = a v_t^2 / (z_b - z)^4 down_B, v_t its speed along the floor. The bottom's depth z_b or
// the reach s is a number to be found. Source: the image in the boundary of what the hull or jet does to the water,
// whose speed falls with the square of the distance (Milne-Thomson 1968; Lamb 1932, sec. 138); the exponential form is
// an assumption. Ignores: growth of the added mass, slope of the bottom, which thruster blows. Revealed by hovering and
// moving at several heights, one within a hull's length of the floor. Confused with compressibility (linear in depth),
// which it becomes when the floor is far.
#include <algorithm>
#include <array>

#include "common/model/boundary.hpp"
#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

using namespace boundary;

constexpr std::array kBottomEffectParameters{
    EffectParameter{"strength", "N m^2", 5.0, -1e4, 1e4}, EffectParameter{"bottom_depth", "m", 20.0},
    EffectParameter{"reach", "m", 0.5, kSmallestReach, kLongestReach, 0.0, false, false, true},
    EffectParameter{"at_depth", "m"}};
constexpr std::size_t kBottomDepth = 1, kReach = 2, kAtDepth = 3;
constexpr double kBottomEffectSmallestRange = 0.05;  // m of depth
constexpr std::array kGaps{0.15, 0.4, 1.0, 2.5};     // m below the deepest place
constexpr std::array kReaches{0.1, 0.3, 0.9};        // of the range of depth

class BottomEffect final : public Effect {
 public:
  std::string_view name() const override { return "bottom_effect"; }
  std::string_view sentence() const override { return "The bottom below is felt when it is near."; }
  std::string_view revealed_by() const override { return "hovering and moving at several heights above the floor"; }
  std::span<const EffectParameter> parameters() const override { return kBottomEffectParameters; }
  int amplitudes() const override { return 1; }
  bool takes_part(int variant, std::size_t number) const override {
    return number == 0 || number == (exponential(variant) ? kReach : kBottomDepth);
  }
  bool is_given(int variant, std::size_t number) const override { return exponential(variant) && number == kAtDepth; }
  bool feels_motion() const override { return false; }
  bool feels_place() const override { return true; }
  bool multiplies_drag(int variant) const override { return multiplies(variant); }
  /// A floor that takes drag away or drives off is none.
  bool possible(const Eigen::Vector3d& p_WB, EffectTheta theta, int variant) const override {
    if (one_sided(variant) && theta[0] < 0.0) return false;
    return exponential(variant) || theta[kBottomDepth] > p_WB.z();
  }
  bool variants_matter() const override { return true; }
  /// One floor.
  bool rules_out(int variant, int other) const override { return multiplies(variant) == multiplies(other); }
  /// The upper edge of a layer of denser water lifts exponentially too, until the vehicle has gone through it.
  Unlisted looks_like(EffectTheta theta, int variant, const Scene&) const override {
    if (variant != kExponentialForce || theta[0] <= 0.0) return {};
    return {"a layer of denser water below", "going deeper, or to the same depth where the bottom is deeper"};
  }
  std::string_view unit(int variant, std::size_t number) const override {
    return number == 0 ? kStrengthUnits[static_cast<std::size_t>(variant)] : kBottomEffectParameters[number].unit;
  }
  std::vector<std::string> variants(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    if (!scene.position || scene.p_high.z() - scene.p_low.z() <= kBottomEffectSmallestRange) return {};
    const bool moves = dof[0] || dof[1] || dof[2];
    return names(dof[2], moves, dof[0] || dof[1]);
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const double range = scene.p_high.z() - scene.p_low.z(), deepest = scene.p_high.z();
    const double force = 0.1 * std::max(scene.tau_rms.head<3>().norm(), 1e-2);
    const double size = multiplies(variant) ? kStartShare : force, speed = scene.nu_rms.head<2>().norm();
    std::vector<std::vector<double>> starts;
    if (exponential(variant)) {
      for (const double share : kReaches)
        starts.push_back({size, 0.0, std::min(share * range, kTypicalReach), deepest});
      return starts;
    }
    for (const double gap : kGaps) {
      const double height = gap + 0.25 * range;  // where it should be worth a tenth of the thrust
      starts.push_back({strength_at(variant, force, height, speed), deepest + gap, 0.0, 0.0});
    }
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    const double z = motion.p_WB.z();
    const double near = theta[0] * (exponential(variant) ? proximity_at(z - theta[kAtDepth], theta[kReach])
                                                         : nearness(variant, theta[kBottomDepth] - z));
    press(variant, near, motion.R_WB.row(2).transpose(), motion.nu_r().head<3>(), load);
  }
};

}  // namespace

const Effect& bottom_effect() {
  static const BottomEffect kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

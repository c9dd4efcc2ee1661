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
    EffectParameter{
        .name = "reach", .unit = "m", .sigma = 0.5, .low = kSmallestReach, .high = kLongestReach, .blurred = true},
    EffectParameter{"at_depth", "m"}};
constexpr std::size_t kBottomDepth = 1, kReach = 2, kAtDepth = 3;
constexpr double kBottomEffectSmallestRange = 0.05;  // m of depth
constexpr std::array kGaps{0.15, 0.4, 1.0, 2.5};     // m below the deepest place
constexpr std::array kReaches{0.1, 0.3, 0.9};        // of the range of depth

class NearBottom final : public Form {
 public:
  explicit NearBottom(const Law& law)
      : Form{traits_of(law, {0, law.exponential() ? kReach : kBottomDepth},
                       law.exponential() ? NumberSet{kAtDepth} : NumberSet{}, law.multiplies() ? kOneDrag : kOneForce)},
        law_{law} {}
  FormName name(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    if (!scene.position || scene.p_high.z() - scene.p_low.z() <= kBottomEffectSmallestRange) return {};
    return when(law_.shows(dof[2], dof[0] || dof[1] || dof[2], dof[0] || dof[1]), law_.name);
  }
  /// A floor that takes drag away or drives off is none, nor one above the middle of the water worked in.
  bool possible(EffectTheta theta, const Scene& scene) const override {
    if (law_.one_sided() && theta[0] < 0.0) return false;
    return law_.exponential() || theta[kBottomDepth] > 0.5 * (scene.p_low.z() + scene.p_high.z());
  }
  /// The upper edge of a layer of denser water lifts exponentially too, until the vehicle has gone through it.
  Unlisted looks_like(EffectTheta theta, const Scene&) const override {
    if (!law_.exponential() || law_.felt != Felt::kPush || theta[0] <= 0.0) return {};
    return {"a layer of denser water below", "going deeper, or to the same depth where the bottom is deeper"};
  }
  Starts starts(const Scene& scene) const override {
    const double range = scene.p_high.z() - scene.p_low.z(), deepest = scene.p_high.z();
    const double force = 0.1 * std::max(scene.tau_rms.head<3>().norm(), 1e-2);
    const double size = law_.multiplies() ? kStartShare : force, speed = scene.nu_rms.head<2>().norm();
    Starts starts;
    if (law_.exponential()) {
      for (const double share : kReaches)
        starts.push_back({size, 0.0, std::min(share * range, kTypicalReach), deepest});
      return starts;
    }
    for (const double gap : kGaps) {
      const double height = gap + 0.25 * range;  // where it should be worth a tenth of the thrust
      starts.push_back({strength_at(law_, force, height, speed), deepest + gap, 0.0, 0.0});
    }
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const double z = motion.p_WB.z();
    const double near = theta[0] * (law_.exponential() ? proximity_at(z - theta[kAtDepth], theta[kReach])
                                                       : nearness(law_, theta[kBottomDepth] - z));
    press(law_, near, motion.R_WB.row(2).transpose(), motion.nu_r().head<3>(), load);
  }

 private:
  enum OneFloor { kOneForce, kOneDrag };  // obeys one law each
  Law law_;
};

}  // namespace

const Effect& bottom_effect() {
  static const Effect kEffect{{.name = "bottom_effect",
                               .sentence = "The bottom below is felt when it is near.",
                               .revealed_by = "hovering and moving at several heights above the floor",
                               .stage = Stage::kBody,
                               .amplitudes = 1,
                               .forms_coexist = true,
                               .feels_motion = false,
                               .feels_place = true},
                              kBottomEffectParameters,
                              form_per_law<NearBottom>()};
  return kEffect;
}

}  // namespace fathom::model::effects

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
#include <array>

#include "common/model/level_boundary.hpp"

namespace fathom::model::effects {
namespace {

using namespace boundary;

constexpr std::array kBottomEffectParameters{
    EffectParameter{"strength", "N m^2", 5.0, -1e4, 1e4}, EffectParameter{"bottom_depth", "m", 20.0},
    EffectParameter{
        .name = "reach", .unit = "m", .sigma = 0.5, .low = kSmallestReach, .high = kLongestReach, .blurred = true},
    EffectParameter{"at_depth", "m"}};

/// The upper edge of denser water lifts exponentially too, until the vehicle has gone through it (layered_water).
constexpr Level kBottom{
    .down = 1.0,
    .looks_like = {"denser water below the depths visited", "going deeper, or to the same depth where the bottom is deeper"}};

class NearBottom final : public NearLevel {
 public:
  explicit NearBottom(const Law& law) : NearLevel{law, kBottom} {}
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

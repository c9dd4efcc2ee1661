// Physics: near the surface a moving hull makes waves, and the water above gives way: laws of a boundary, as
// bottom_effect.cpp has them, with the plane above: `force` pushes down (a > 0) or draws up; `drag`, the hull's own
// grows (wave resistance); `suction`, with the square of the speed along it. Each fades with the inverse square or
// exponentially, told for the shallowest place visited; suction with the inverse fourth power. The surface's depth, 0
// where depth is counted from it, or the reach is a number to be found. Source: image of the hull above the surface
// (Milne-Thomson 1968; Newman 1977, ch. 6: waves' pressure falls off exponentially with depth). Ignores: how wave
// resistance depends on the Froude number, added mass near the surface. Revealed by the same motion just below the
// surface and several hull's heights deeper. Confused with compressibility (linear in depth), which it becomes far
// from it, and with bottom_effect in shallow water.
#include <array>

#include "common/model/level_boundary.hpp"

namespace fathom::model::effects {
namespace {

using namespace boundary;

constexpr std::array kSurfaceEffectParameters{
    EffectParameter{"strength", "N m^2", 5.0, -1e4, 1e4}, EffectParameter{"surface_depth", "m", 1.0},
    EffectParameter{
        .name = "reach", .unit = "m", .sigma = 0.5, .low = kSmallestReach, .high = kLongestReach, .blurred = true},
    EffectParameter{"at_depth", "m"}};

/// Lighter water above lets the vehicle sink as a push would.
constexpr Level kSurface{
    .down = -1.0,
    .looks_like = {"lighter water above the depths visited", "the same motion at the same depth when the water is mixed"}};

class NearSurface final : public NearLevel {
 public:
  explicit NearSurface(const Law& law) : NearLevel{law, kSurface} {}
  FormName name(const Scene& scene) const override {
    return near_surface(scene) ? NearLevel::name(scene) : std::nullopt;
  }
};

}  // namespace

const Effect& surface_effect() {
  static const Effect kEffect{
      {.name = "surface_effect",
       .sentence = "The surface above is felt when it is near.",
       .revealed_by = "the same motion just below the surface and several hull's heights deeper",
       .stage = Stage::kBody,
       .amplitudes = 1,
       .forms_coexist = true,
       .feels_motion = false,
       .feels_place = true},
      kSurfaceEffectParameters,
      form_per_law<NearSurface>()};
  return kEffect;
}

}  // namespace fathom::model::effects

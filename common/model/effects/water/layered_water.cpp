// Physics: water lies in layers (a pycnocline: warm on cold, fresh on salt), and what a vehicle displaces weighs more
// below: its buoyancy grows by the step b about the depth z_l, w = -b s(z) down_B; the constant part is the base
// model's W-B, as it is above. Forms: `two layers` with an edge between them, s = (1 + tanh(x + c x^3)) / 2, x = (z -
// z_l) / h, whose flanks c are those of turbulent mixing (0), of diffusion (0.07: an error function within 0.1 %) or of
// a straight ramp (more); `mixed above`, water that wind or a pump has mixed down to z_l and below it grows denser as
// it settles, s = 1 - exp(-x). The step is that of the density times gravity and the displaced volume: 1 kg/m^3 is
// worth a thousandth of the craft's weight. Source: hydrostatics (Fossen 2011, sec. 4.1); profiles of mixing layers and
// of the upper ocean (Turner 1973, ch. 4 and 9). Ignores: several edges, waves within the layer, the moment where the
// edge lies within the hull's height, that drag and added mass grow with density too (a thousandth for each kg/m^3).
// Never lighter below: such water turns over. Revealed by slow dives through the edge, both ways, with pauses above and
// below. Confused with compressibility where the edge is as wide as the dive is deep, and with bottom_effect where the
// vehicle has kept clear of the edge: that is no layer here.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::size_t kStep = 0, kDepth = 1, kWidth = 2, kFlanks = 3;
constexpr int kOneProfile = 0;        // both forms are laws of one and the same water
constexpr double kThinnest = 0.02;    // m: sharper, it passes within a sample
constexpr double kLeastDepths = 0.3;  // m that must have been visited: less would be within the hull's height
constexpr double kWidest = 0.5;       // of the range of depth: wider, it is a line
// Of the range of depth, where a search looks for it: what is buoyant over a strong step comes no deeper than its edge.
constexpr std::array kPlaces{0.25, 0.5, 0.75, 0.9, 1.0};
constexpr std::array kWidths{0.04, 0.2};

constexpr std::array kLayeredWaterParameters{
    EffectParameter{"buoyancy_step", "N", 3.0, 0.0, 1e4}, EffectParameter{"edge_depth", "m", 100.0},
    EffectParameter{.name = "edge_width", .unit = "m", .sigma = 1.0, .low = kThinnest, .high = 50.0, .blurred = true},
    EffectParameter{.name = "flanks", .unit = "", .sigma = 0.1, .low = 0.0, .high = 1.0, .blurred = true}};

double range_of(const Scene& scene) { return scene.p_high.z() - scene.p_low.z(); }

class Profile : public Form {
 public:
  Profile(const char* name, NumberSet sought) : Form{{.sought = sought, .obeys = kOneProfile}}, name_{name} {}
  FormName name(const Scene& scene) const final {
    return when(scene.position && scene.vehicle->dof[2] && range_of(scene) > kLeastDepths, name_);
  }
  /// The vehicle has been above the edge, where W-B is meant, and so near to it that it bends: farther off, an
  /// exponential is all that shows.
  bool possible(EffectTheta theta, const Scene& scene) const final {
    return theta[kStep] >= 0.0 && theta[kWidth] <= kWidest * range_of(scene) && theta[kDepth] > scene.p_low.z() &&
           theta[kDepth] - theta[kWidth] < scene.p_high.z();
  }
  Starts starts(const Scene& scene) const final {
    const double range = std::max(range_of(scene), kLeastDepths), force = 0.1 * std::max(scene.tau_rms[2], 1e-2);
    Starts starts;
    for (const double place : kPlaces) {
      if (place == 1.0 && share(0.0, 0.0) == 0.0) continue;  // nothing of it would show at the deepest place
      for (const double width : kWidths)
        starts.push_back({force, scene.p_low.z() + place * range, std::max(width * range, kThinnest), 0.0});
    }
    return starts;
  }
  void load(const Motion& motion, EffectTheta theta, Load& load) const final {
    const double below = (motion.p_WB.z() - theta[kDepth]) / std::max(theta[kWidth], kThinnest);
    load.wrench.head<3>() -= theta[kStep] * share(below, theta[kFlanks]) * motion.R_WB.row(2).transpose();
  }

 protected:
  /// Of the step, so many widths below its depth.
  [[nodiscard]] virtual double share(double below, double flanks) const = 0;

 private:
  const char* name_;
};

class TwoLayers final : public Profile {
 public:
  TwoLayers() : Profile{"two layers", {kStep, kDepth, kWidth, kFlanks}} {}
  double share(double below, double flanks) const override {
    return 0.5 * (1.0 + std::tanh(below + flanks * below * below * below));
  }
};

class MixedAbove final : public Profile {
 public:
  MixedAbove() : Profile{"mixed above", {kStep, kDepth, kWidth}} {}
  double share(double below, double) const override { return below > 0.0 ? -std::expm1(-below) : 0.0; }
};

}  // namespace

const Effect& layered_water() {
  static const Effect kEffect{{.name = "layered_water",
                               .sentence = "Below some depth the water is denser.",
                               .revealed_by = "slow dives through its edge, with pauses above and below",
                               .finding = "Buoyancy grows by {buoyancy_step} about a depth of {edge_depth}",
                               .stage = Stage::kBody,
                               .amplitudes = 1,
                               .feels_motion = false,
                               .feels_place = true},
                              kLayeredWaterParameters,
                              forms(TwoLayers{}, MixedAbove{})};
  return kEffect;
}

}  // namespace fathom::model::effects

// Physics: a sensor's scale is off (speed of sound of a velocity log, gyro gain): nu_measured,i = (1 + s) nu_i for one
// component. Source: the definition of a scale error. Ignores: offsets, scale that changes with temperature. Revealed
// by motions that couple axes, since along one axis alone masses, drag and thrust absorb it whole; a position measured
// beside the velocity shows it directly, which the consistency check uses before any fit. Confused with all base
// parameters of that axis.
#include <algorithm>
#include <array>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kSensorScaleParameters{EffectParameter{"error", "", 0.1, -0.9, 4.0}};

// Products of velocities in each row of C(nu) nu, docs/model.md (2).
constexpr std::array<std::array<std::array<int, 2>, 2>, 6> kProducts{{{{{4, 2}, {5, 1}}},
                                                                      {{{5, 0}, {3, 2}}},
                                                                      {{{3, 1}, {4, 0}}},
                                                                      {{{1, 2}, {4, 5}}},
                                                                      {{{2, 0}, {5, 3}}},
                                                                      {{{0, 1}, {3, 4}}}}};
constexpr double kMoves = 0.01;  // m/s, rad/s RMS

/// True when the component enters another simulated axis' equation: only there its scale shows.
bool couples(const Scene& scene, int component) {
  for (std::size_t row = 0; row < 6; ++row) {
    if (!scene.vehicle->dof[row]) continue;
    for (const auto& [a, b] : kProducts[row]) {
      if (a == component && scene.nu_rms[b] > kMoves) return true;
      if (b == component && scene.nu_rms[a] > kMoves) return true;
    }
  }
  return false;
}

class ScaleOfOneComponent final : public Form {
 public:
  explicit ScaleOfOneComponent(int component) : component_{component} {}
  FormName name(const Scene& scene) const override {
    const auto axis = static_cast<std::size_t>(component_);
    const bool measured =
        axis < 3 ? scene.velocity && !scene.velocity_checked() : scene.rates && !scene.rates_checked();
    return when(scene.vehicle->dof[axis] && measured && couples(scene, component_), kVelocityNames[axis]);
  }
  Starts starts(const Scene&) const override { return {{0.05}}; }
  void measure(VelocityView& nu, double, EffectTheta theta) const override { nu.row(component_) *= 1.0 + theta[0]; }
  void unmeasure(VelocityView& nu, double, EffectTheta theta) const override { nu.row(component_) /= 1.0 + theta[0]; }

 private:
  int component_;
};

}  // namespace

const Effect& sensor_scale() {
  static const Effect kEffect{{.name = "sensor_scale",
                               .sentence = "A sensor shows more or less than there is, in proportion.",
                               .revealed_by = "turning while moving: axes coupled by known physics",
                               .finding = "{form} shows {error more} than there is",
                               .stage = Stage::kSensor,
                               .forms_coexist = true,
                               .feels_motion = false},
                              kSensorScaleParameters,
                              forms(ScaleOfOneComponent{0}, ScaleOfOneComponent{1}, ScaleOfOneComponent{2},
                                    ScaleOfOneComponent{3}, ScaleOfOneComponent{4}, ScaleOfOneComponent{5})};
  return kEffect;
}

}  // namespace fathom::model::effects

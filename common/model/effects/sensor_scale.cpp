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

class SensorScale final : public Effect {
 public:
  std::string_view name() const override { return "sensor_scale"; }
  std::string_view sentence() const override { return "A sensor shows more or less than there is, in proportion."; }
  std::string_view revealed_by() const override { return "turning while moving: axes coupled by known physics"; }
  std::span<const EffectParameter> parameters() const override { return kSensorScaleParameters; }
  bool feels_motion() const override { return false; }
  bool variants_matter() const override { return true; }
  std::vector<std::string> variants(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    std::vector<std::string> names;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const bool measured =
          dof[axis] && (axis < 3 ? scene.velocity && !scene.velocity_checked() : scene.rates && !scene.rates_checked());
      names.emplace_back(measured && couples(scene, static_cast<int>(axis)) ? kVelocityNames[axis] : "-");
    }
    const bool any = std::any_of(names.begin(), names.end(), [](const std::string& one) { return one != "-"; });
    return any ? names : std::vector<std::string>{};
  }
  std::vector<std::vector<double>> starts(const Scene&, int) const override { return {{0.05}}; }
  bool measures() const override { return true; }
  void measure(VelocityView& nu, double, EffectTheta theta, int variant) const override {
    nu.row(variant) *= 1.0 + theta[0];
  }
  void unmeasure(VelocityView& nu, double, EffectTheta theta, int variant) const override {
    nu.row(variant) /= 1.0 + theta[0];
  }
};

}  // namespace

const Effect& sensor_scale() {
  static const SensorScale kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

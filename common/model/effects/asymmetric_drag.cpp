// Physics: the hull drags differently ahead than astern (up than down): even terms beside the odd ones, X = X_uu u_r^2
// (Pereira and Duncan eq. 4), X = X_|u| |u_r|, or both, as where all of the drag is larger astern. Ignores: asymmetry
// of turning. Revealed by equal speed in both directions, at several speeds. Confused with thrust_asymmetry, current
// and tether pulls.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"coefficient", "N/(m/s)^2", 10.0},
                                 EffectParameter{"linear", "N/(m/s)", 5.0}};
constexpr std::array kNames{"X_uu",  "Y_vv",       "Z_ww",       "X_|u|",     "Y_|v|",
                            "Z_|w|", "X_|u| X_uu", "Y_|v| Y_vv", "Z_|w| Z_ww"};

constexpr int axis_of(int variant) { return variant % 3; }
constexpr bool quadratic(int variant) { return variant / 3 != 1; }
constexpr bool linear(int variant) { return variant / 3 != 0; }

class AsymmetricDrag final : public Effect {
 public:
  std::string_view name() const override { return "asymmetric_drag"; }
  std::string_view sentence() const override {
    return "The hull drags differently in one direction than in the other.";
  }
  std::string_view revealed_by() const override { return "equal speeds in both directions along the axis"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  bool takes_part(int variant, std::size_t number) const override {
    return number == 0 ? quadratic(variant) : linear(variant);
  }
  bool feels_motion() const override { return false; }
  bool variants_matter() const override { return true; }
  std::vector<std::string> variants(const Scene& scene) const override {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < kNames.size(); ++i) names.emplace_back(scene.vehicle->dof[i % 3] ? kNames[i] : "-");
    return names;
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const double speed = std::max(scene.nu_rms[axis_of(variant)], 1e-3);
    const double force = 0.02 * std::max(scene.tau_rms[axis_of(variant)], 1e-3);
    return {{quadratic(variant) ? force / (speed * speed) : 0.0, linear(variant) ? force / speed : 0.0}};
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    const double velocity = motion.nu_r()[axis_of(variant)];
    if (quadratic(variant)) load.wrench[axis_of(variant)] += theta[0] * velocity * velocity;
    if (linear(variant)) load.wrench[axis_of(variant)] += theta[1] * std::abs(velocity);
  }
};

}  // namespace

const Effect& asymmetric_drag() {
  static const AsymmetricDrag kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

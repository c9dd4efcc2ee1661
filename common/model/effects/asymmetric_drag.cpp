// Physics: the hull drags differently ahead than astern (up than down): an even term beside the odd one,
// X = X_uu u_r^2 (Pereira and Duncan eq. 4). Ignores: an even part of the linear drag.
// Revealed by equal speed in both directions. Confused with thrust_asymmetry, current and tether pulls.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"coefficient", "N/(m/s)^2", 10.0}};

class AsymmetricDrag final : public Effect {
 public:
  std::string_view name() const override { return "asymmetric_drag"; }
  std::string_view sentence() const override {
    return "The hull drags differently in one direction than in the other.";
  }
  std::string_view revealed_by() const override { return "equal speeds in both directions along the axis"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  bool feels_motion() const override { return false; }
  bool variants_matter() const override { return true; }
  std::vector<std::string> variants(const Scene& scene) const override {
    constexpr std::array<const char*, 3> kNames{"X_uu", "Y_vv", "Z_ww"};
    std::vector<std::string> names;
    for (std::size_t axis = 0; axis < 3; ++axis) names.emplace_back(scene.vehicle->dof[axis] ? kNames[axis] : "-");
    return names;
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const double speed = std::max(scene.nu_rms[variant], 1e-3);
    return {{0.02 * std::max(scene.tau_rms[variant], 1e-3) / (speed * speed)}};
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    const double velocity = motion.nu_r()[variant];
    load.wrench[variant] += theta[0] * velocity * velocity;
  }
};

}  // namespace

const Effect& asymmetric_drag() {
  static const AsymmetricDrag kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

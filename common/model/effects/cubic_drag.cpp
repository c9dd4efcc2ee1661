// Physics: drag that grows faster than the square of speed (wave making, vortex shedding of appendages, high
// blockage): w_i = -c nu_r,i^3, the next odd term of the Taylor expansion (Abkowitz 1964; Fossen 2011, sec. 6.4).
// c >= 0, so that it only takes energy. Ignores: cubic products of two axes. Revealed by the full range of speeds along
// one axis, top speed included. Confused with quadratic drag, which takes most of it, and with thrust_loss.
#include <algorithm>
#include <array>

#include "common/model/effect.hpp"
#include "common/model/parameters.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kCubicDragParameters{EffectParameter{"coefficient", "N/(m/s)^3", 50.0, 0.0, 1e5}};

class CubicDrag final : public Effect {
 public:
  std::string_view name() const override { return "cubic_drag"; }
  std::string_view sentence() const override { return "Drag grows faster than the square of speed."; }
  std::string_view revealed_by() const override { return "slow, medium and top speed along one axis"; }
  std::span<const EffectParameter> parameters() const override { return kCubicDragParameters; }
  bool feels_motion() const override { return false; }
  bool variants_matter() const override { return true; }
  std::string_view unit(int variant, std::size_t) const override { return drag_unit(variant, variant, 3); }
  std::vector<std::string> variants(const Scene& scene) const override {
    constexpr std::array<const char*, 6> kNames{"X_uuu", "Y_vvv", "Z_www", "K_ppp", "M_qqq", "N_rrr"};
    std::vector<std::string> names;
    for (std::size_t axis = 0; axis < 6; ++axis) names.emplace_back(scene.vehicle->dof[axis] ? kNames[axis] : "-");
    return names;
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const double speed = std::max(scene.nu_rms[variant], 1e-2);
    return {{0.05 * std::max(scene.tau_rms[variant], 1e-3) / (speed * speed * speed)}};
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    const double velocity = motion.nu_r()[variant];
    load.wrench[variant] -= theta[0] * velocity * velocity * velocity;
  }
};

}  // namespace

const Effect& cubic_drag() {
  static const CubicDrag kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

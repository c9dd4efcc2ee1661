// Physics: weight acts at the centre of gravity, buoyancy at the centre of buoyancy; the first moment
// G = r_G W - r_B B turns the vehicle: moment G x down_B (Fossen 2011, eq. 4.5). The base model has G_x, G_y, G_z where
// the vehicle file frees them; a component that it leaves out is asked for here. A yaw moment needs a tilt:
// N = G_x down_y - G_y down_x. Ignores: a centre that moves with time. Revealed by tilted attitudes held for a while.
// Confused with thruster arms (follow thrust, not tilt) and, over small tilt, with a steady cross_coupling.
#include <algorithm>
#include <array>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"offset", "N m", 5.0}};
constexpr double kSmallestTilt = 0.01;  // rad: less and yaw feels nothing

class RestoringMoment final : public Effect {
 public:
  std::string_view name() const override { return "restoring_moment"; }
  std::string_view sentence() const override {
    return "The centres of gravity and buoyancy lie apart in a way the model does not know.";
  }
  std::string_view revealed_by() const override { return "tilted attitudes, each held for several seconds"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  bool feels_motion() const override { return false; }
  bool variants_matter() const override { return true; }
  std::vector<std::string> variants(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    const bool yaw_feels = dof[5] && scene.tilt_rms > kSmallestTilt;
    const std::array acts{dof[4] || yaw_feels, dof[3] || yaw_feels, dof[3] || dof[4]};
    constexpr std::array<const char*, 3> kNames{"G_x", "G_y", "G_z"};
    std::vector<std::string> names;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& free = scene.vehicle->parameters;
      const bool in_base = std::find(free.begin(), free.end(), kNames[i]) != free.end();
      names.emplace_back(acts[i] && !in_base ? kNames[i] : "-");
    }
    const bool any = std::any_of(names.begin(), names.end(), [](const std::string& one) { return one != "-"; });
    return any ? names : std::vector<std::string>{};
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    const Eigen::Vector3d down_B = motion.R_WB.row(2).transpose();
    load.wrench.tail<3>() += theta[0] * Eigen::Vector3d::Unit(variant).cross(down_B);
  }
};

}  // namespace

const Effect& restoring_moment() {
  static const RestoringMoment kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

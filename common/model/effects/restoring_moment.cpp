// Physics: weight acts at the centre of gravity, buoyancy at the centre of buoyancy; the first moment
// G = r_G W - r_B B turns the vehicle: moment G x down_B (Fossen 2011, eq. 4.5). The base model has G_x, G_y, G_z where
// the vehicle file frees them; a component that it leaves out is asked for here. A yaw moment needs a tilt:
// N = G_x down_y - G_y down_x. Ignores: a centre that moves with time. Revealed by tilted attitudes held for a while.
// Confused with thruster arms (follow thrust, not tilt) and, over small tilt, with a steady cross_coupling.
#include <algorithm>
#include <array>

#include "common/model/component_set.hpp"
#include "common/model/vehicle.hpp"
#include "common/model/wide_prior.hpp"

namespace fathom::model::effects {
namespace {

// Components are sought together: what hangs askew is not even nearly described by one of them.
constexpr std::array kRestoringMomentParameters{EffectParameter{"G_x", "N m", 5.0}, EffectParameter{"G_y", "N m", 5.0},
                                                EffectParameter{"G_z", "N m", 5.0}};
constexpr std::array kFarStarts{1.0 / 3.0, 1.0};  // of the G_z that a prior allows: of a vehicle that rights itself
constexpr double kSmallestTilt = 0.01;            // rad: less and yaw feels nothing

class RestoringMoment final : public Effect {
 public:
  std::string_view name() const override { return "restoring_moment"; }
  std::string_view sentence() const override {
    return "The centres of gravity and buoyancy lie apart in a way the model does not know.";
  }
  std::string_view revealed_by() const override { return "tilted attitudes, each held for several seconds"; }
  std::span<const EffectParameter> parameters() const override { return kRestoringMomentParameters; }
  bool takes_part(int variant, std::size_t number) const override { return in_set(variant, number); }
  int amplitudes() const override { return 3; }
  bool feels_motion() const override { return false; }
  std::vector<std::string> variants(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    const auto& free = scene.vehicle->parameters;
    const bool yaw_feels = dof[5] && scene.tilt_rms > kSmallestTilt;
    const std::array acts{dof[4] || yaw_feels, dof[3] || yaw_feels, dof[3] || dof[4]};
    int form = 0;
    std::string name;
    for (std::size_t i = 0; i < 3; ++i) {
      const bool in_base = std::find(free.begin(), free.end(), kRestoringMomentParameters[i].name) != free.end();
      if (!acts[i] || in_base) continue;
      form |= 1 << i;
      name += (name.empty() ? "" : ", ") + std::string{kRestoringMomentParameters[i].name};
    }
    return forms_of(form, name);
  }

  /// Beside a pendulum that it does not know, a base model takes the inertia away, and no small pendulum helps.
  std::vector<std::vector<double>> far_starts(const Scene& scene, int variant) const override {
    if (!in_set(variant, 2)) return {};
    std::vector<std::vector<double>> starts;
    for (const double share : kFarStarts)
      starts.push_back({0.0, 0.0, share * wide_prior(BaseParameter::G_z, *scene.vehicle).sigma});
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    const Eigen::Vector3d down_B = motion.R_WB.row(2).transpose();
    load.wrench.tail<3>() += components(theta, variant).cross(down_B);
  }
};

}  // namespace

const Effect& restoring_moment() {
  static const RestoringMoment kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

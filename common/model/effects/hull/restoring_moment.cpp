// Physics: weight acts at the centre of gravity, buoyancy at the centre of buoyancy; the first moment
// G = r_G W - r_B B turns the vehicle: moment G x down_B (Fossen 2011, eq. 4.5). The base model has G_x, G_y, G_z where
// the vehicle file frees them; a component that it leaves out is asked for here. A yaw moment needs a tilt:
// N = G_x down_y - G_y down_x. Ignores: a centre that moves with time. Revealed by tilted attitudes held for a while.
// Confused with thruster arms (follow thrust, not tilt) and, over small tilt, with a steady cross_coupling.
#include <algorithm>
#include <array>

#include "common/model/component_set.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

// Components are sought together: what hangs askew is not even nearly described by one of them.
constexpr EffectParameter component(std::string_view name) {
  return {.name = name, .unit = "N m", .sigma = 5.0, .drawn_within = DrawnWithin::kRightingMoment};
}
constexpr std::array kRestoringMomentParameters{component("G_x"), component("G_y"), component("G_z")};
constexpr double kSmallestTilt = 0.01;  // rad: less and yaw feels nothing

class CentresApart final : public OneOfMany {
 public:
  explicit CentresApart(int set) : OneOfMany{{.sought = numbers_of(set)}}, set_{set} {}
  FormName name(const Scene& scene) const override {
    return when(set_ != 0 && set_ == asked_on(scene), names_of(kRestoringMomentParameters, set_));
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const Eigen::Vector3d down_B = motion.R_WB.row(2).transpose();
    load.wrench.tail<3>() += components(theta, set_).cross(down_B);
  }

 private:
  static int asked_on(const Scene& scene) {
    const auto& dof = scene.vehicle->dof;
    const auto& free = scene.vehicle->parameters;
    const bool yaw_feels = dof[5] && scene.tilt_rms > kSmallestTilt;
    const std::array acts{dof[4] || yaw_feels, dof[3] || yaw_feels, dof[3] || dof[4]};
    int set = 0;
    for (std::size_t i = 0; i < acts.size(); ++i) {
      const bool in_base = std::find(free.begin(), free.end(), kRestoringMomentParameters[i].name) != free.end();
      if (acts[i] && !in_base) set |= 1 << i;
    }
    return set;
  }

  int set_;
};

}  // namespace

const Effect& restoring_moment() {
  static const Effect kEffect{
      {.name = "restoring_moment",
       .sentence = "The centres of gravity and buoyancy lie apart in a way the model does not know.",
       .revealed_by = "tilted attitudes, each held for several seconds",
       .stage = Stage::kBody,
       .amplitudes = 3,
       .feels_motion = false},
      kRestoringMomentParameters,
      form_per_set<CentresApart>()};
  return kEffect;
}

}  // namespace fathom::model::effects

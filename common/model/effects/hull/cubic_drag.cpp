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

class CubeOfOneAxis final : public Form {
 public:
  CubeOfOneAxis(int axis, const char* name) : Form{{.unit = drag_unit(axis, axis, 3)}}, name_{name}, axis_{axis} {}
  FormName name(const Scene& scene) const override {
    return when(scene.vehicle->dof[static_cast<std::size_t>(axis_)], name_);
  }
  Starts starts(const Scene& scene) const override {
    const double speed = std::max(scene.nu_rms[axis_], 1e-2);
    return {{0.05 * std::max(scene.tau_rms[axis_], 1e-3) / (speed * speed * speed)}};
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const double velocity = motion.nu_r()[axis_];
    load.wrench[axis_] -= theta[0] * velocity * velocity * velocity;
  }

 private:
  const char* name_;
  int axis_;
};

}  // namespace

const Effect& cubic_drag() {
  static const Effect kEffect{{.name = "cubic_drag",
                               .sentence = "Drag grows faster than the square of speed.",
                               .revealed_by = "slow, medium and top speed along one axis",
                               .stage = Stage::kBody,
                               .forms_coexist = true,
                               .feels_motion = false},
                              kCubicDragParameters,
                              forms(CubeOfOneAxis{0, "X_uuu"}, CubeOfOneAxis{1, "Y_vvv"}, CubeOfOneAxis{2, "Z_www"},
                                    CubeOfOneAxis{3, "K_ppp"}, CubeOfOneAxis{4, "M_qqq"}, CubeOfOneAxis{5, "N_rrr"})};
  return kEffect;
}

}  // namespace fathom::model::effects

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
constexpr std::size_t kQuadratic = 0, kLinear = 1;

/// Even terms of one axis: the quadratic one, the linear one, or both.
class EvenDrag final : public Form {
 public:
  EvenDrag(std::size_t axis, const char* name, NumberSet terms)
      : Form{{.sought = terms}}, name_{name}, dof_{axis}, axis_{static_cast<Eigen::Index>(axis)} {}
  FormName name(const Scene& scene) const override { return when(scene.vehicle->dof[dof_], name_); }
  Starts starts(const Scene& scene) const override {
    const double speed = std::max(scene.nu_rms[axis_], 1e-3);
    const double force = 0.02 * std::max(scene.tau_rms[axis_], 1e-3);
    return {{traits().sought.has(kQuadratic) ? force / (speed * speed) : 0.0,
             traits().sought.has(kLinear) ? force / speed : 0.0}};
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const double velocity = motion.nu_r()[axis_];
    if (traits().sought.has(kQuadratic)) load.wrench[axis_] += theta[kQuadratic] * velocity * velocity;
    if (traits().sought.has(kLinear)) load.wrench[axis_] += theta[kLinear] * std::abs(velocity);
  }

 private:
  const char* name_;
  std::size_t dof_;
  Eigen::Index axis_;
};

}  // namespace

const Effect& asymmetric_drag() {
  constexpr NumberSet kSquare{kQuadratic}, kShare{kLinear}, kBoth{kQuadratic, kLinear};
  static const Effect kEffect{
      {.name = "asymmetric_drag",
       .sentence = "The hull drags differently in one direction than in the other.",
       .revealed_by = "equal speeds in both directions along the axis",
       .stage = Stage::kBody,
       .forms_coexist = true,
       .feels_motion = false},
      kParameters,
      forms(EvenDrag{0, "X_uu", kSquare}, EvenDrag{1, "Y_vv", kSquare}, EvenDrag{2, "Z_ww", kSquare},
            EvenDrag{0, "X_|u|", kShare}, EvenDrag{1, "Y_|v|", kShare}, EvenDrag{2, "Z_|w|", kShare},
            EvenDrag{0, "X_|u| X_uu", kBoth}, EvenDrag{1, "Y_|v| Y_vv", kBoth}, EvenDrag{2, "Z_|w| Z_ww", kBoth})};
  return kEffect;
}

}  // namespace fathom::model::effects

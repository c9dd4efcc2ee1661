// Physics: a stalled hull drags with the square of its whole speed against its path, so the resistance along each axis
// goes with that speed and not with the axis' own alone: w_i = -c |v_r| nu_r,i, v_r the velocity through the water
// (Hoerner 1965, ch. 3; Fossen 2011, sec. 6.4 and 7.1 for surge and cross-flow apart). Of turning: w_i = -c |v_r| w_i,
// a damping that grows with the speed ahead (N_|U|r of the standard equations; Feldman 1979). c >= 0, so that it only
// takes energy. Ignores: lift. Revealed by moving obliquely, and by turning at rest and at speed. Confused with the
// quadratic drag of the axis while that axis alone moves, and with body_lift (which has the sign of the speed ahead).
#include <algorithm>
#include <array>

#include "common/model/speed_products.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kSpeedDragParameters{
    EffectParameter{.name = "coefficient", .unit = "N/(m/s)^2", .sigma = 50.0, .low = 0.0, .high = 1e5}};
constexpr double kMoves = 0.02;  // m/s: less beside the axis' own speed tells nothing
constexpr double kShare = 0.05;  // of the thrust, where a search begins

class DragByWholeSpeed final : public Form {
 public:
  DragByWholeSpeed(Eigen::Index axis, const char* name)
      : Form{{.unit = axis < 3 ? "N/(m/s)^2" : "N m/(m/s)/(rad/s)"}}, name_{name}, axis_{axis} {}
  FormName name(const Scene& scene) const override {
    return when(lives_by_flow(*scene.vehicle) && scene.vehicle->dof[static_cast<std::size_t>(axis_)] &&
                    scene.nu_rms[axis_] > 0.0 && others(scene) > kMoves,
                name_);
  }
  Starts starts(const Scene& scene) const override {
    const double speed = std::max(scene.nu_rms.head<3>().norm(), 1e-2), own = std::max(scene.nu_rms[axis_], 1e-2);
    return {{kShare * std::max(scene.tau_rms[axis_], 1e-3) / (speed * own)}};
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const Vector6d nu_r = motion.nu_r();
    load.wrench[axis_] -= theta[0] * nu_r.head<3>().norm() * nu_r[axis_];
  }

 private:
  /// m/s, of the axes beside this one.
  [[nodiscard]] double others(const Scene& scene) const {
    Eigen::Vector3d v = scene.nu_rms.head<3>();
    if (axis_ < 3) v[axis_] = 0.0;
    return v.norm();
  }

  const char* name_;
  Eigen::Index axis_;
};

}  // namespace

const Effect& speed_drag() {
  static const Effect kEffect{
      {.name = "speed_drag",
       .sentence = "Drag along an axis grows with the whole speed, not with that axis' own.",
       .revealed_by = "moving obliquely, and turning at rest and at full speed",
       .stage = Stage::kBody,
       .amplitudes = 1,
       .forms_coexist = true,
       .feels_motion = false,
       .own_flow = true},
      kSpeedDragParameters,
      forms(DragByWholeSpeed{0, "X_|V|u"}, DragByWholeSpeed{1, "Y_|V|v"}, DragByWholeSpeed{2, "Z_|V|w"},
            DragByWholeSpeed{3, "K_|V|p"}, DragByWholeSpeed{4, "M_|V|q"}, DragByWholeSpeed{5, "N_|V|r"})};
  return kEffect;
}

}  // namespace fathom::model::effects

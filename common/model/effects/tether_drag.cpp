// Physics: the tether in the water drags as the vehicle pulls it along, the more of it the more is paid out. Length:
// the straight way to the fixed end, L = |p - p_A|; force at the vehicle w = -k L |v_r| v_r, the share of 1/2 rho C_d d
// L |v|v that does not end at the other end (Driscoll and Nahon 1996; Fossen 2011, sec. 6.4 for the form); `linear`, of
// slow motion and thin tethers: w = -k L v_r; `across its line`, of a straight smooth cable, along which the water
// hardly drags (Driscoll and Nahon 1996): w = -k L |v_n| v_n, v_n the part of v_r across the way to the fixed end.
// Ignores: slack beyond the straight way, the tether's weight and tension, its drag in the current alone. Made fast at
// Bo, or at a place p_BC in B that is to be found (attachment.hpp): what counts is then that place's own v_r + w x
// p_BC, and the force turns the vehicle by p_BC x w. Revealed by the same speeds near and far from the fixed end.
// Confused with the drag of the mean length, with cross_coupling and with tether_tension.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/attachment.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kTetherDragParameters{EffectParameter{"coefficient", "N/(m/s)^2/m", 5.0, 0.0, 1e4},
                                           EffectParameter{"anchor_N", "m", 20.0},
                                           EffectParameter{"anchor_E", "m", 20.0},
                                           EffectParameter{"anchor_D", "m", 10.0},
                                           kAttachment[0],
                                           kAttachment[1],
                                           kAttachment[2]};
constexpr std::size_t kAttached = 4;  // its first number
constexpr int kLinear = 8;            // after the sets of an attachment's components: none of these forms has any
constexpr int kAcross = 16;
constexpr int kBearings = 8;
constexpr double kSwaying = 0.01;  // rad/s of roll and pitch, measured if not simulated: they move a high cleat

class TetherDrag final : public Effect {
 public:
  std::string_view name() const override { return "tether_drag"; }
  std::string_view sentence() const override { return "The tether drags through the water, more the longer it is."; }
  std::string_view revealed_by() const override {
    return "the same speeds near the tether's fixed end and far from it";
  }
  std::span<const EffectParameter> parameters() const override { return kTetherDragParameters; }
  int amplitudes() const override { return 1; }
  bool feels_motion() const override { return false; }
  bool feels_place() const override { return true; }
  std::vector<std::string> variants(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    const bool seen = scene.position && scene.attitude && (dof[0] || dof[1] || dof[2]);
    const bool sways = scene.nu_rms.segment<2>(3).norm() > kSwaying;
    if (!seen) return {};
    std::vector<std::string> forms = attachment_forms(*scene.vehicle, sways);
    forms.resize(kLinear, "-");
    forms.emplace_back("linear");
    forms.resize(kAcross, "-");
    forms.emplace_back("across its line");
    return forms;
  }
  std::string_view unit(int variant, std::size_t number) const override {
    return variant == kLinear && number == 0 ? "N/(m/s)/m" : kTetherDragParameters[number].unit;
  }
  bool takes_part(int variant, std::size_t number) const override {
    return number < kAttached || in_set(variant, number - kAttached);
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const Eigen::Vector3d middle = 0.5 * (scene.p_low + scene.p_high);
    const double reach = std::max(0.5 * (scene.p_high - scene.p_low).head<2>().norm(), 0.5);
    const double speed = std::max(scene.nu_rms.head<3>().norm(), 1e-2);
    const double slope = 0.2 * std::max(scene.tau_rms.head<3>().norm(), 1e-2) / (speed * reach);
    const double coefficient = variant == kLinear ? slope : slope / speed;
    std::vector<std::vector<double>> starts{{coefficient, middle.x(), middle.y(), middle.z(), 0.0, 0.0, 0.0}};
    for (int k = 0; k < kBearings; ++k) {
      const double bearing = 2.0 * std::numbers::pi * k / kBearings;
      starts.push_back({coefficient, middle.x() + 1.2 * reach * std::cos(bearing),
                        middle.y() + 1.2 * reach * std::sin(bearing), middle.z(), 0.0, 0.0, 0.0});
    }
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    if (theta[0] == 0.0) return;
    const Eigen::Vector3d p_BC = components(theta, variant, kAttached);
    Eigen::Vector3d way = Eigen::Vector3d(theta[1], theta[2], theta[3]) - motion.p_WB;
    Eigen::Vector3d v_r = motion.nu_r().head<3>();
    const bool elsewhere = variant != 0 && variant != kLinear && variant != kAcross;
    if (elsewhere) {
      way -= motion.R_WB * p_BC;
      v_r += motion.nu.tail<3>().cross(p_BC);
    }
    if (variant == kAcross) {
      const Eigen::Vector3d along = (motion.R_WB.transpose() * way).stableNormalized();
      v_r -= along.dot(v_r) * along;
    }
    const Eigen::Vector3d drag = -theta[0] * way.norm() * (variant == kLinear ? 1.0 : v_r.norm()) * v_r;
    load.wrench.head<3>() += drag;
    if (elsewhere) load.wrench.tail<3>() += p_BC.cross(drag);
  }
};

}  // namespace

const Effect& tether_drag() {
  static const TetherDrag kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

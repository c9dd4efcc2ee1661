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
constexpr int kBearings = 8;

/// A line of straight length, made fast at the origin or off it.
class LineInWater : public Form {
 public:
  explicit LineInWater(int set, std::optional<std::string_view> unit = {})
      : Form{{.sought = numbers_of(set, kAttached), .unit = unit}}, set_{set} {}
  void load(const Motion& motion, EffectTheta theta, Load& load) const final {
    if (theta[0] == 0.0) return;
    const Eigen::Vector3d p_BC = components(theta, set_, kAttached);
    Eigen::Vector3d way = Eigen::Vector3d(theta[1], theta[2], theta[3]) - motion.p_WB;
    Eigen::Vector3d v_r = motion.nu_r().head<3>();
    if (set_ != 0) {
      way -= motion.R_WB * p_BC;
      v_r += motion.nu.tail<3>().cross(p_BC);
    }
    const Eigen::Vector3d drag = drag_of(theta, way, motion.R_WB, v_r);
    load.wrench.head<3>() += drag;
    if (set_ != 0) load.wrench.tail<3>() += p_BC.cross(drag);
  }
  Starts starts(const Scene& scene) const final {
    const Eigen::Vector3d middle = 0.5 * (scene.p_low + scene.p_high);
    const double reach = std::max(0.5 * (scene.p_high - scene.p_low).head<2>().norm(), 0.5);
    const double speed = std::max(scene.nu_rms.head<3>().norm(), 1e-2);
    const double slope = 0.2 * std::max(scene.tau_rms.head<3>().norm(), 1e-2) / (speed * reach);
    const double coefficient = coefficient_of(slope, speed);
    Starts starts{{coefficient, middle.x(), middle.y(), middle.z(), 0.0, 0.0, 0.0}};
    for (int k = 0; k < kBearings; ++k) {
      const double bearing = 2.0 * std::numbers::pi * k / kBearings;
      starts.push_back({coefficient, middle.x() + 1.2 * reach * std::cos(bearing),
                        middle.y() + 1.2 * reach * std::sin(bearing), middle.z(), 0.0, 0.0, 0.0});
    }
    return starts;
  }

 protected:
  /// N in B; `way` to the fixed end, m in W, and `v_r` past the water, m/s in B, of where it is made fast.
  [[nodiscard]] virtual Eigen::Vector3d drag_of(EffectTheta theta, const Eigen::Vector3d& way,
                                                const Eigen::Matrix3d& R_WB, const Eigen::Vector3d& v_r) const = 0;
  /// Of `slope` N/(m/s) per metre at a speed of so many m/s.
  [[nodiscard]] virtual double coefficient_of(double slope, double speed) const { return slope / speed; }
  static bool seen(const Scene& scene) {
    const auto& dof = scene.vehicle->dof;
    return scene.position && scene.attitude && (dof[0] || dof[1] || dof[2]);
  }
  int set_;
};

class SquareOfSpeed final : public LineInWater {
 public:
  using LineInWater::LineInWater;
  FormName name(const Scene& scene) const override {
    return seen(scene) ? attachment_name(set_, attachment_set(*scene.vehicle, sways(scene))) : std::nullopt;
  }

 private:
  Eigen::Vector3d drag_of(EffectTheta theta, const Eigen::Vector3d& way, const Eigen::Matrix3d&,
                          const Eigen::Vector3d& v_r) const override {
    return -theta[0] * way.norm() * v_r.norm() * v_r;
  }
};

class OfSlowMotion final : public LineInWater {
 public:
  OfSlowMotion() : LineInWater{0, "N/(m/s)/m"} {}
  FormName name(const Scene& scene) const override { return when(seen(scene), "linear"); }

 private:
  Eigen::Vector3d drag_of(EffectTheta theta, const Eigen::Vector3d& way, const Eigen::Matrix3d&,
                          const Eigen::Vector3d& v_r) const override {
    return -theta[0] * way.norm() * v_r;
  }
  double coefficient_of(double slope, double) const override { return slope; }
};

class AcrossItsLine final : public LineInWater {
 public:
  AcrossItsLine() : LineInWater{0} {}
  FormName name(const Scene& scene) const override { return when(seen(scene), "across its line"); }

 private:
  Eigen::Vector3d drag_of(EffectTheta theta, const Eigen::Vector3d& way, const Eigen::Matrix3d& R_WB,
                          const Eigen::Vector3d& v_r) const override {
    const Eigen::Vector3d along = (R_WB.transpose() * way).stableNormalized();
    const Eigen::Vector3d v_n = v_r - along.dot(v_r) * along;
    return -theta[0] * way.norm() * v_n.norm() * v_n;
  }
};

Forms every_line() {
  Forms all = form_per_set<SquareOfSpeed>();
  all.push_back(std::make_unique<OfSlowMotion>());
  all.push_back(std::make_unique<AcrossItsLine>());
  return all;
}

}  // namespace

const Effect& tether_drag() {
  static const Effect kEffect{{.name = "tether_drag",
                               .sentence = "The tether drags through the water, more the longer it is.",
                               .revealed_by = "the same speeds near the tether's fixed end and far from it",
                               .stage = Stage::kBody,
                               .amplitudes = 1,
                               .feels_motion = false,
                               .feels_place = true},
                              kTetherDragParameters,
                              every_line()};
  return kEffect;
}

}  // namespace fathom::model::effects

// Physics: one thruster pushes in another direction than its file says, or at another arm. Its axis a becomes R(e, x)
// a, turned by x about a body axis e at its own place, or its place p becomes p + x e:
//   w = f_i [R a - a; p x (R a - a)]   or   w = f_i [0; x e x a]      (columns of the allocation, Fossen 2011,
//   sec. 12.3)
// Where the vehicle file gives the allocation alone, p is the shortest arm with that moment: how far along its own axis
// the thruster sits is then unknown, and a turn may be told with a shift that it has not. Ignores: that the jet then
// meets the hull elsewhere. Revealed by driving that thruster alone, on each side of its command. Confused with
// thruster_gain (same axes, when the thruster already turns the vehicle) and cross_coupling (follows speed, not
// thrust).
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrusterMisalignmentParameters{EffectParameter{"error", "rad", 0.1, -1.2, 1.2}};
constexpr int kForms = 6;  // per thruster: turned about x, y, z; shifted along x, y, z
constexpr std::array<const char*, kForms> kFormNames{"turned about x",  "turned about y",  "turned about z",
                                                     "shifted along x", "shifted along y", "shifted along z"};
constexpr double kSmallestChange = 0.05;  // of a unit of force, per unit of error: less moves nothing
constexpr double kParallel = 0.999;       // cosine between two changes that nothing can tell apart

/// Change of the column of the allocation of thruster `i`.
Vector6d change(const Vehicle& vehicle, Eigen::Index i, int form, double error) {
  const Vector6d column = vehicle.allocation.col(i);
  const Eigen::Vector3d axis_B = column.head<3>();
  const Eigen::Vector3d e = Eigen::Vector3d::Unit(form % 3);
  Vector6d moved = Vector6d::Zero();
  if (form >= 3) {
    moved.tail<3>() = error * e.cross(axis_B);
    return moved;
  }
  // The allocation gives the arm across the axis, the place how far along it: of no account before the turn, but after.
  const Eigen::Vector3d& p_BJ = vehicle.thrusters[static_cast<std::size_t>(i)].p_BJ;
  const Eigen::Vector3d arm =
      (axis_B.cross(column.tail<3>()) + axis_B.dot(p_BJ) * axis_B) / std::max(axis_B.squaredNorm(), 1e-9);
  moved.head<3>() = Eigen::AngleAxisd{error, e} * axis_B - axis_B;
  moved.tail<3>() = arm.cross(moved.head<3>());
  return moved;
}

class ThrusterMisalignment final : public Effect {
 public:
  std::string_view name() const override { return "thruster_misalignment"; }
  std::string_view sentence() const override { return "One thruster pushes in another direction or at another place."; }
  std::string_view revealed_by() const override { return "each thruster driven by itself, ahead and in reverse"; }
  std::span<const EffectParameter> parameters() const override { return kThrusterMisalignmentParameters; }
  bool feels_motion() const override { return false; }
  std::string_view unit(int variant, std::size_t) const override { return variant % kForms < 3 ? "rad" : "m"; }
  bool variants_matter() const override { return true; }
  std::vector<std::string> variants(const Scene& scene) const override {
    if (scene.input_is_wrench) return {};
    std::vector<std::string> names;
    const auto& dof = scene.vehicle->dof;
    for (std::size_t i = 0; i < scene.vehicle->thrusters.size(); ++i) {
      std::vector<Vector6d> seen;
      for (int form = 0; form < kForms; ++form) {
        Vector6d direction = change(*scene.vehicle, static_cast<Eigen::Index>(i), form, 1e-3) / 1e-3;
        for (Eigen::Index axis = 0; axis < 6; ++axis) {
          if (!dof[static_cast<std::size_t>(axis)]) direction[axis] = 0.0;
        }
        const double size = direction.norm();
        const bool new_one = std::none_of(seen.begin(), seen.end(), [&](const Vector6d& other) {
          return std::abs(other.dot(direction)) > kParallel * other.norm() * size;
        });
        const bool visible = size > kSmallestChange && new_one;
        if (visible) seen.push_back(direction);
        names.push_back(visible ? scene.vehicle->thrusters[i].name + " " + kFormNames[static_cast<std::size_t>(form)]
                                : "-");
      }
    }
    return names;
  }
  std::vector<std::vector<double>> starts(const Scene&, int variant) const override {
    return {{variant % kForms < 3 ? 0.05 : 0.02}};
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    const Eigen::Index thruster = variant / kForms;
    const auto& allocation = motion.vehicle->allocation;
    if (theta[0] == 0.0 || motion.force.size() != allocation.cols() || thruster >= allocation.cols()) return;
    load.wrench += motion.force[thruster] * change(*motion.vehicle, thruster, variant % kForms, theta[0]);
  }
};

}  // namespace

const Effect& thruster_misalignment() {
  static const ThrusterMisalignment kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

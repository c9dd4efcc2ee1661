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
#include "common/model/one_of_many.hpp"
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

class OneAskew final : public OfThruster {
 public:
  OneAskew(Eigen::Index thruster, int way) : OfThruster{thruster, {.unit = way < 3 ? "rad" : "m"}}, way_{way} {}
  FormName name(const Scene& scene) const override {
    if (scene.input_is_wrench || !exists(scene)) return {};
    if (!visible(*scene.vehicle, way_)) return {};
    return scene.vehicle->thrusters[place()].name + " " + kFormNames[static_cast<std::size_t>(way_)];
  }
  Starts starts(const Scene&) const override { return {{way_ < 3 ? 0.05 : 0.02}}; }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const auto& allocation = motion.vehicle->allocation;
    if (theta[0] == 0.0 || motion.force.size() != allocation.cols() || thruster_ >= allocation.cols()) return;
    load.wrench += motion.force[thruster_] * change(*motion.vehicle, thruster_, way_, theta[0]);
  }

 private:
  /// Per unit of error, on the axes that are simulated.
  [[nodiscard]] Vector6d direction(const Vehicle& vehicle, int way) const {
    Vector6d direction = change(vehicle, thruster_, way, 1e-3) / 1e-3;
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      if (!vehicle.dof[static_cast<std::size_t>(axis)]) direction[axis] = 0.0;
    }
    return direction;
  }
  /// Moves something, and in another direction than every visible one before it.
  [[nodiscard]] bool visible(const Vehicle& vehicle, int way) const {
    const Vector6d itself = direction(vehicle, way);
    const double size = itself.norm();
    if (size <= kSmallestChange) return false;
    for (int before = 0; before < way; ++before) {
      const Vector6d other = direction(vehicle, before);
      if (std::abs(other.dot(itself)) > kParallel * other.norm() * size && visible(vehicle, before)) return false;
    }
    return true;
  }

  int way_;
};

Forms every_way_of_each() {
  Forms all;
  for (Eigen::Index thruster = 0; thruster < kMaxActuators; ++thruster) {
    for (int way = 0; way < kForms; ++way) all.push_back(std::make_unique<OneAskew>(thruster, way));
  }
  return all;
}

}  // namespace

const Effect& thruster_misalignment() {
  static const Effect kEffect{{.name = "thruster_misalignment",
                               .sentence = "One thruster pushes in another direction or at another place.",
                               .revealed_by = "each thruster driven by itself, ahead and in reverse",
                               .stage = Stage::kBody,
                               .forms_coexist = true,
                               .feels_motion = false},
                              kThrusterMisalignmentParameters,
                              every_way_of_each()};
  return kEffect;
}

}  // namespace fathom::model::effects

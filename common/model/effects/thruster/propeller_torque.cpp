// Physics: the water's torque on a propeller turns the vehicle about the propeller's axis. Torque and thrust both go
// with the square of the shaft speed, so w = k f [0; a], k = (K_Q / K_T) D, negative for a propeller that turns
// clockwise seen from behind (Fossen 2011, sec. 12.3). Forms: each thruster; "all", where none runs against another's
// sense. Ignores: advance, stators that take the swirl out of the jet, and the rotor's own inertia (switching_moment).
// Revealed by constant thrust at rest: the vehicle lists. Confused with restoring_moment and centre_of_mass, which stay
// when the thrust is off.
#include <array>
#include <cmath>

#include "common/model/one_of_many.hpp"
#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kPropellerTorqueParameters{EffectParameter{"torque_per_force", "m", 0.02, -0.3, 0.3}};
constexpr double kStart = 0.005;    // m
constexpr double kSmallest = 0.05;  // of an axis, along what is simulated: less turns nothing

/// By the allocation, which every vehicle file states in one way or the other.
auto axis_of(const Vehicle& vehicle, Eigen::Index thruster) { return vehicle.allocation.col(thruster).head<3>(); }

bool turns(const Vehicle& vehicle, Eigen::Index thruster) {
  if (!is_propeller(vehicle.thrusters[static_cast<std::size_t>(thruster)])) return false;
  for (Eigen::Index k = 0; k < 3; ++k)
    if (vehicle.dof[static_cast<std::size_t>(3 + k)] && std::abs(axis_of(vehicle, thruster)[k]) > kSmallest)
      return true;
  return false;
}

class OneTorque final : public OfThruster {
 public:
  using OfThruster::OfThruster;
  FormName name(const Scene& scene) const override {
    if (scene.input_is_wrench || !exists(scene)) return {};
    return when(turns(*scene.vehicle, thruster_), scene.vehicle->thrusters[place()].name);
  }
  Starts starts(const Scene&) const override { return {{kStart}}; }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (!by_thruster(motion) || thruster_ >= motion.force.size()) return;
    load.wrench.tail<3>() += theta[0] * motion.force[thruster_] * axis_of(*motion.vehicle, thruster_);
  }
};

class EveryTorque final : public OneOfMany {
 public:
  bool exists(const Scene&) const override { return true; }
  FormName name(const Scene& scene) const override {
    int count = 0;
    for (std::size_t i = 0; i < scene.vehicle->thrusters.size(); ++i)
      count += turns(*scene.vehicle, static_cast<Eigen::Index>(i)) ? 1 : 0;
    return when(!scene.input_is_wrench && count > 1, "all");
  }
  Starts starts(const Scene&) const override { return {{kStart}}; }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (!by_thruster(motion)) return;
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) {
      if (!is_no_propeller(motion, i))
        load.wrench.tail<3>() += theta[0] * motion.force[i] * axis_of(*motion.vehicle, i);
    }
  }
};

Forms all_and_each() {
  Forms all;
  all.push_back(std::make_unique<EveryTorque>());
  for (Eigen::Index i = 0; i < kMaxActuators; ++i) all.push_back(std::make_unique<OneTorque>(i));
  return all;
}

}  // namespace

const Effect& propeller_torque() {
  static const Effect kEffect{
      {.name = "propeller_torque",
       .sentence = "A propeller's torque turns the vehicle about the propeller's axis.",
       .revealed_by = "constant thrust of each thruster by itself, at rest and both ways",
       .finding = "{thruster} turns the vehicle about its own axis by {torque_per_force} times its thrust",
       .stage = Stage::kBody,
       .forms_coexist = true,
       .feels_motion = false},
      kPropellerTorqueParameters,
      all_and_each()};
  return kEffect;
}

}  // namespace fathom::model::effects

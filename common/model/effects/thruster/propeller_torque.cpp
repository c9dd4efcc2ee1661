// Physics: the water's torque on a propeller turns the vehicle about the propeller's axis: w = k f [0; a], negative for
// a propeller that turns clockwise seen from behind (Fossen 2011, sec. 12.3); at rest k = (K_Q / K_T) D. With the
// advance thrust and torque fall each by its own straight line (K_T and K_Q over J), so of a propeller whose file
// states how its thrust falls w = (k f_a + h (f - f_a)) [0; a], f its force at rest and f_a as it acts: h = k if the
// torque did not fall, 0 if it fell as the thrust does; K_Q falls by three quarters where K_T is gone (Wageningen
// B-series). Forms: each thruster; "all", where none runs against another's sense. Ignores: stators that take the swirl
// out of the jet, and the rotor's own inertia (switching_moment). Revealed by constant thrust at rest: the vehicle
// lists. Confused with restoring_moment and centre_of_mass, which stay when the thrust is off.
#include <array>
#include <cmath>

#include "common/model/actuators.hpp"
#include "common/model/one_of_many.hpp"
#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kPropellerTorqueParameters{EffectParameter{"torque_per_force", "m", 0.02, -0.3, 0.3},
                                                EffectParameter{"torque_per_lost_force", "m", 0.02, -0.3, 0.3}};
constexpr NumberSet kAtRest{0};
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

bool loses_thrust(const Vehicle& vehicle, std::size_t thruster) { return vehicle.thrusters[thruster].inflow > 0.0; }

/// N m about the thruster's own axis.
double torque(const Motion& motion, EffectTheta theta, Eigen::Index thruster) {
  if (!loses_thrust(*motion.vehicle, static_cast<std::size_t>(thruster))) return theta[0] * motion.force[thruster];
  const double acting = acting_force(*motion.vehicle, motion, thruster);
  return theta[0] * acting + theta[1] * (motion.force[thruster] - acting);
}

class OneTorque : public OfThruster {
 public:
  explicit OneTorque(Eigen::Index thruster, NumberSet sought = kAtRest) : OfThruster{thruster, {.sought = sought}} {}
  FormName name(const Scene& scene) const override { return named(scene, false); }
  Starts starts(const Scene&) const override { return {{kStart, 0.0}}; }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (!by_thruster(motion) || thruster_ >= motion.force.size()) return;
    load.wrench.tail<3>() += torque(motion, theta, thruster_) * axis_of(*motion.vehicle, thruster_);
  }

 protected:
  FormName named(const Scene& scene, bool losing) const {
    if (scene.input_is_wrench || !exists(scene) || loses_thrust(*scene.vehicle, place()) != losing) return {};
    return when(turns(*scene.vehicle, thruster_), scene.vehicle->thrusters[place()].name);
  }
};

class OneTorqueUnderWay final : public OneTorque {
 public:
  explicit OneTorqueUnderWay(Eigen::Index thruster) : OneTorque{thruster, NumberSet::all()} {}
  FormName name(const Scene& scene) const override { return named(scene, true); }
};

class EveryTorque : public OneOfMany {
 public:
  explicit EveryTorque(NumberSet sought = kAtRest) : OneOfMany{{.sought = sought}} {}
  bool exists(const Scene&) const override { return true; }
  FormName name(const Scene& scene) const override { return named(scene, false); }
  Starts starts(const Scene&) const override { return {{kStart, 0.0}}; }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (!by_thruster(motion)) return;
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) {
      if (!is_no_propeller(motion, i)) load.wrench.tail<3>() += torque(motion, theta, i) * axis_of(*motion.vehicle, i);
    }
  }

 protected:
  static FormName named(const Scene& scene, bool losing) {
    int count = 0;
    bool loses = false;
    for (std::size_t i = 0; i < scene.vehicle->thrusters.size(); ++i) {
      if (!turns(*scene.vehicle, static_cast<Eigen::Index>(i))) continue;
      ++count;
      loses = loses || loses_thrust(*scene.vehicle, i);
    }
    return when(!scene.input_is_wrench && count > 1 && loses == losing, "all");
  }
};

class EveryTorqueUnderWay final : public EveryTorque {
 public:
  EveryTorqueUnderWay() : EveryTorque{NumberSet::all()} {}
  bool exists(const Scene& scene) const override { return name(scene).has_value(); }
  FormName name(const Scene& scene) const override { return named(scene, true); }
};

Forms all_and_each() {
  Forms all;
  all.push_back(std::make_unique<EveryTorque>());
  for (Eigen::Index i = 0; i < kMaxActuators; ++i) all.push_back(std::make_unique<OneTorque>(i));
  all.push_back(std::make_unique<EveryTorqueUnderWay>());
  for (Eigen::Index i = 0; i < kMaxActuators; ++i) all.push_back(std::make_unique<OneTorqueUnderWay>(i));
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
       .amplitudes = 2,
       .forms_coexist = true,
       .feels_motion = false},
      kPropellerTorqueParameters,
      all_and_each()};
  return kEffect;
}

}  // namespace fathom::model::effects

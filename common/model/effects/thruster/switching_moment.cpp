// Physics: what comes with each change of a thruster's push and goes again: a vehicle that rolls when one propeller is
// switched, and hardly while it runs. The rotor's gain of angular momentum turns the vehicle the other way, and a jet
// that starts takes water along before it goes straight. w = k e (f - g), T g_dot = f - g, e a moment about a body axis
// that the thruster does not drive while it runs. Forms: each thruster about each such axis. Source: conservation of
// angular momentum of vehicle and rotor, shaft speed following the command in first order. Ignores: the shaft's true
// course; both ways are alike. Revealed by steps of one thruster, each held for seconds. Confused with
// thruster_misalignment and propeller_torque, which last as long as the thrust.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/decay_share.hpp"
#include "common/model/one_of_many.hpp"
#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kSwitchingMomentParameters{EffectParameter{"moment_per_force", "m", 0.05, -1.0, 1.0},
                                                EffectParameter{"time_constant", "s", 0.5, 0.05, 10.0}};
constexpr std::array<const char*, 3> kAbout{" about x", " about y", " about z"};
constexpr double kStart = 0.01;  // m
// m: with a longer arm the thruster drives the axis, and what comes late is its thrust.
constexpr double kDriven = 0.02;

class OneKick final : public OfThruster {
 public:
  OneKick(Eigen::Index thruster, int axis) : OfThruster{thruster}, axis_{axis} {}
  FormName name(const Scene& scene) const override {
    if (scene.input_is_wrench || !exists(scene)) return {};
    const Vehicle& vehicle = *scene.vehicle;
    const Thruster& one = vehicle.thrusters[place()];
    const bool free = vehicle.dof[static_cast<std::size_t>(3 + axis_)] && is_propeller(one) &&
                      std::abs(vehicle.allocation(3 + axis_, thruster_)) < kDriven;
    return when(free, one.name + kAbout[static_cast<std::size_t>(axis_)]);
  }
  Starts starts(const Scene&) const override { return {{kStart, 0.2}, {kStart, 1.0}}; }
  int state_size(int) const override { return 2; }  // g, and the thrust that was felt last
  double run_in(EffectTheta theta) const override { return run_in_for(theta[1]); }

  void settle(const Motion& motion, EffectTheta, std::span<double> z) const override { z[0] = z[1] = force(motion); }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
    thread_local DecayShare decay;
    z[1] = force(motion);
    z[0] += decay(dt, theta[1]) * (z[1] - z[0]);
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double> z) const override {
    motion.w_memory[3 + axis_] += theta[0] * (z[1] - z[0]);
  }

 private:
  [[nodiscard]] double force(const Motion& motion) const {
    return thruster_ < motion.force.size() ? motion.force[thruster_] : 0.0;
  }
  int axis_;
};

Forms about_every_axis_of_each() {
  Forms all;
  for (Eigen::Index thruster = 0; thruster < kMaxActuators; ++thruster)
    for (int axis = 0; axis < 3; ++axis) all.push_back(std::make_unique<OneKick>(thruster, axis));
  return all;
}

}  // namespace

const Effect& switching_moment() {
  static const Effect kEffect{{.name = "switching_moment",
                               .sentence = "A moment comes with each change of a thruster's push and goes again.",
                               .revealed_by = "steps of each thruster by itself, held for several seconds",
                               .stage = Stage::kWater,
                               .amplitudes = 1,
                               .forms_coexist = true,
                               .feels_motion = false,
                               .remembers_motion = true},
                              kSwitchingMomentParameters,
                              about_every_axis_of_each()};
  return kEffect;
}

}  // namespace fathom::model::effects

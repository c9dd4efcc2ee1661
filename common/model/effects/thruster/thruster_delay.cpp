// Physics: the command reaches the propellers late by a fixed time (bus, ESC, on-board computer), or the log's clocks
// of command and motion differ by as much. f(t) = f_c(t - T), for all thrusters alike, or T + dT for those that push up
// and down, which are often of another make (thruster_kinds.hpp). Source: the definition of a dead time. Ignores:
// jitter; a delay of its own per thruster. Revealed by steps and fast reversals along every axis. Confused with
// thruster_lag (a delay shifts, a lag also rounds) and, over a narrow band, with added mass.
#include <array>

#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrusterDelayParameters{
    EffectParameter{.name = "delay", .unit = "s", .sigma = 0.1, .low = 0.0, .high = 1.5, .after_command = true},
    EffectParameter{"vertical_later", "s", 0.1, -1.5, 1.5}};

constexpr std::size_t kVerticalLater = 1;

class AllAlike final : public Form {
 public:
  AllAlike() : Form{{.sought = {0}}} {}
  Starts starts(const Scene&) const override { return {{0.05, 0.0}, {0.2, 0.0}, {0.5, 0.0}}; }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (motion.input != nullptr && theta[0] != 0.0) motion.input->ago(motion.t, theta[0], motion.force);
  }
};

class VerticalApart final : public Form {
 public:
  FormName name(const Scene& scene) const override { return when(has_both_kinds(scene), "vertical thrusters apart"); }
  Starts starts(const Scene&) const override { return {{0.05, 0.15}, {0.2, 0.1}, {0.2, -0.15}}; }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (motion.input == nullptr) return;
    const double later = time_of_vertical(theta[0], theta[kVerticalLater]);
    if (later == theta[0]) {
      if (theta[0] != 0.0) motion.input->ago(motion.t, theta[0], motion.force);
      return;
    }
    ActuatorForces others = motion.force, vertical = motion.force;
    if (theta[0] != 0.0) motion.input->ago(motion.t, theta[0], others);
    if (later != 0.0) motion.input->ago(motion.t, later, vertical);
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) {
      motion.force[i] = is_vertical(*motion.vehicle, i, motion.force.size()) ? vertical[i] : others[i];
    }
  }
};

}  // namespace

const Effect& thruster_delay() {
  static const Effect kEffect{
      {.name = "thruster_delay",
       .sentence = "Thrust follows the logged command late by a fixed time, or all sensors are late alike.",
       .revealed_by = "steps and reversals of thrust, each held for several seconds",
       .finding = "Thrust comes {delay late}",
       .stage = Stage::kCommand,
       .feels_motion = false},
      kThrusterDelayParameters,
      forms(AllAlike{}, VerticalApart{})};
  return kEffect;
}

}  // namespace fathom::model::effects

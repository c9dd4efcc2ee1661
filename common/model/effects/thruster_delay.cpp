// Physics: the command reaches the propellers late by a fixed time (bus, ESC, on-board computer), or the log's clocks
// of command and motion differ by as much. f(t) = f_c(t - T), for all thrusters alike, or T + dT for those that push up
// and down, which are often of another make (thruster_kinds.hpp). Source: the definition of a dead time. Ignores:
// jitter; a delay of its own per thruster. Revealed by steps and fast reversals along every axis. Confused with
// thruster_lag (a delay shifts, a lag also rounds) and, over a narrow band, with added mass.
#include <array>

#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrusterDelayParameters{EffectParameter{"delay", "s", 0.1, 0.0, 1.5, 0.0, true},
                                              EffectParameter{"vertical_later", "s", 0.1, -1.5, 1.5}};
enum ThrusterDelayForm { kAlike, kTwoKinds };

class ThrusterDelay final : public Effect {
 public:
  std::string_view name() const override { return "thruster_delay"; }
  std::string_view sentence() const override {
    return "Thrust follows the logged command late by a fixed time, or all sensors are late alike.";
  }
  std::string_view revealed_by() const override {
    return "steps and reversals of thrust, each held for several seconds";
  }
  std::span<const EffectParameter> parameters() const override { return kThrusterDelayParameters; }
  bool feels_motion() const override { return false; }
  bool takes_part(int variant, std::size_t number) const override { return number == 0 || variant == kTwoKinds; }
  std::vector<std::string> variants(const Scene& scene) const override {
    return {"", has_both_kinds(scene) ? "vertical thrusters apart" : "-"};
  }
  std::vector<std::vector<double>> starts(const Scene&, int variant) const override {
    if (variant == kTwoKinds) return {{0.05, 0.15}, {0.2, 0.1}, {0.2, -0.15}};
    return {{0.05, 0.0}, {0.2, 0.0}, {0.5, 0.0}};
  }

  void feel(Motion& motion, EffectTheta theta, int variant, std::span<const double>) const override {
    if (motion.input == nullptr) return;
    const double later = variant == kTwoKinds ? time_of_vertical(theta[0], theta[1]) : theta[0];
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
  static const ThrusterDelay kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

// Physics: a propeller in water at rest pushes harder than one whose own inflow has built up: after a step of command
// the thrust peaks, then sinks to its steady value (Healey et al. 1995; Whitcomb and Yoerger 1999). First order in the
// inflow: f = f_c - k g, T g_dot = f_c - g. The steady thrust is (1 - k) f_c, the first instant's f_c. Forms: all
// thrusters alike, or only those that push sideways (horizontal) or only those that push up (vertical), since a jet's
// fate depends on what it meets. Ignores: that T shrinks with the jet's speed. Revealed by steps held for several T.
// Confused with mass and linear drag together, and with fluid_memory.
#include <array>
#include <cmath>

#include "common/model/decay_share.hpp"
#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrustOvershootParameters{EffectParameter{"share_lost", "", 0.3, 0.0, 0.98},
                                                EffectParameter{"time_constant", "s", 1.0, 0.05, 10.0}};

/// Of all thrusters, or of one kind.
class FadingThrust : public Form {
 public:
  FormName name(const Scene&) const override { return "all"; }
  Starts starts(const Scene&) const final { return {{0.1, 0.3}, {0.1, 1.0}, {0.1, 3.0}}; }
  int state_size(int actuators) const final { return actuators; }
  double run_in(EffectTheta theta) const final { return run_in_for(theta[1]); }

  void settle(const Motion& motion, EffectTheta, std::span<double> z) const final {
    for (std::size_t i = 0; i < z.size(); ++i) z[i] = motion.force[static_cast<Eigen::Index>(i)];
  }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const final {
    thread_local DecayShare decay;
    const double share = decay(dt, theta[1]);
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += share * (motion.force[static_cast<Eigen::Index>(i)] - z[i]);
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double> z) const final {
    for (std::size_t i = 0; i < z.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if (fades(*motion.vehicle, k, motion.force.size()) && !is_no_propeller(motion, k))
        motion.force[k] -= theta[0] * z[i];
    }
  }

 protected:
  [[nodiscard]] virtual bool fades(const Vehicle&, Eigen::Index, Eigen::Index) const { return true; }
};

class HorizontalFades final : public FadingThrust {
 public:
  FormName name(const Scene& scene) const override { return when(has_both_kinds(scene), "horizontal"); }

 private:
  bool fades(const Vehicle& vehicle, Eigen::Index i, Eigen::Index of) const override {
    return !is_vertical(vehicle, i, of);
  }
};

class VerticalFades final : public FadingThrust {
 public:
  FormName name(const Scene& scene) const override { return when(has_both_kinds(scene), "vertical"); }

 private:
  bool fades(const Vehicle& vehicle, Eigen::Index i, Eigen::Index of) const override {
    return is_vertical(vehicle, i, of);
  }
};

}  // namespace

const Effect& thrust_overshoot() {
  static const Effect kEffect{{.name = "thrust_overshoot",
                               .sentence = "Thrust peaks after each change of command and then fades.",
                               .revealed_by = "steps of thrust held for five seconds and more",
                               .finding = "Thrust peaks after each change of command and loses {share_lost %} of it, "
                                          "with a time constant of {time_constant}",
                               .stage = Stage::kThrust,
                               .amplitudes = 1,
                               .forms_coexist = true,
                               .feels_motion = false},
                              kThrustOvershootParameters,
                              forms(FadingThrust{}, HorizontalFades{}, VerticalFades{})};
  return kEffect;
}

}  // namespace fathom::model::effects

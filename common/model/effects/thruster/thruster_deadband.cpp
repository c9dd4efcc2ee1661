// Physics: small commands turn no propeller (static friction, ESC threshold). Forms: `offset` f = sign(f_c)
// max(|f_c| - d, 0); `step`, nothing below d and the full force above it; `rounded`, a propeller that creeps at first,
// f = f_c s^2 (3 - 2 s) with s = min(|f_c| / d, 1), the smoothest cubic from nothing to all. Source: makers' thrust
// curves about neutral, and Coulomb's friction; the rounded law is an assumption. Ignores: a band of its own per
// thruster; beside a delay, the way of a command within a sample. Revealed by small commands around zero. Confused with
// lower thruster gain when all commands are alike in size.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrusterDeadbandParameters{EffectParameter{"half_width", "N", 0.5, 0.0, 50.0}};
constexpr double kFirstStep = 0.04, kLastStep = 1.0;  // of the typical command
constexpr double kNextStep = 1.15;                    // times the one before: constant commands are often close to it
constexpr double kFlank = 0.01;                       // of the width, at least: keeps the step differentiable

/// The mean of a step at `edge` over forces from `force` - `across` / 2 to `force` + `across` / 2, which may lie on
/// both sides of zero.
double mean_over_step(double force, double edge, double across) {
  if (std::abs(force) - 0.5 * across >= edge) return force;  // exactly: the difference below rounds
  const auto integral = [edge](double to) { return 0.5 * std::max(to * to - edge * edge, 0.0); };
  return (integral(force + 0.5 * across) - integral(force - 0.5 * across)) / across;
}

/// N, of the commands.
double typical(const Scene& scene) { return scene.force_rms.size() > 0 ? scene.force_rms.maxCoeff() : 1.0; }
Starts shares_of_typical(const Scene& scene) {
  return {{0.05 * typical(scene)}, {0.2 * typical(scene)}, {0.5 * typical(scene)}};
}

class Offset final : public Form {
 public:
  FormName name(const Scene&) const override { return "offset"; }
  Starts starts(const Scene& scene) const override { return shares_of_typical(scene); }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (theta[0] <= 0.0) return;
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) {
      double& force = motion.force[i];
      if (!is_no_propeller(motion, i)) force = std::copysign(std::max(std::abs(force) - theta[0], 0.0), force);
    }
  }
};

class Step final : public Form {
 public:
  FormName name(const Scene&) const override { return "step"; }
  /// Only commands at a step's edge tell where it is: no slope leads there from afar.
  Starts starts(const Scene& scene) const override {
    Starts starts;
    for (double share = kFirstStep; share < kLastStep; share *= kNextStep) starts.push_back({share * typical(scene)});
    return starts;
  }
  double left_open(EffectTheta theta, std::size_t) const override { return kFlank * theta[0] / std::sqrt(12.0); }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    const double half = theta[0];
    if (half <= 0.0) return;
    ActuatorForces told, across;
    const bool knows_way = motion.input != nullptr;
    if (knows_way) {
      motion.input->now(motion.t, told);
      motion.input->change(motion.t, across);
    }
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) {
      if (is_no_propeller(motion, i)) continue;
      double& force = motion.force[i];
      // A command that passes the step's edge between two samples is on either side for its share of the time. One
      // that was delayed has been on its way at another time.
      const double way = knows_way && force == told[i] ? std::abs(across[i]) : 0.0;
      force = mean_over_step(force, half, std::max(way, kFlank * half));
    }
  }
};

class Rounded final : public Form {
 public:
  FormName name(const Scene&) const override { return "rounded"; }
  Starts starts(const Scene& scene) const override { return shares_of_typical(scene); }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (theta[0] <= 0.0) return;
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) {
      if (is_no_propeller(motion, i)) continue;
      double& force = motion.force[i];
      const double share = std::min(std::abs(force) / theta[0], 1.0);
      force *= share * share * (3.0 - 2.0 * share);
    }
  }
};

}  // namespace

const Effect& thruster_deadband() {
  static const Effect kEffect{{.name = "thruster_deadband",
                               .sentence = "Small commands produce no thrust.",
                               .revealed_by = "small thrust commands that change sign",
                               .finding = "Commands below {half_width} give no thrust",
                               .stage = Stage::kCommand,
                               .feels_motion = false},
                              kThrusterDeadbandParameters,
                              forms(Offset{}, Step{}, Rounded{})};
  return kEffect;
}

}  // namespace fathom::model::effects

// Physics: the water remembers past motion (shed vortices, surface waves): a force that follows velocity late,
//   mu_i = -k z_i,  T z_dot_i = nu_r,i - z_i,   that is  -int K(t - s) nu_r(s) ds  with K = k/T exp(-t/T)
// (Cummins 1962; one term of the state-space form in Fossen 2011, sec. 5.4.2). k > 0 takes energy at every frequency.
// k may be negative beside a linear drag: drag then grows with frequency instead of falling. Forms: one axis alone, or
// all axes that move, each with a k of its own and one time constant for all: vortices and waves of one hull last
// alike, and how much of each axis' drag they are no file knows. Ignores: more than one time constant, coupling between
// axes. Revealed by the same speeds reached slowly and quickly. Confused with linear drag (motions slower than T),
// added mass (faster ones) and thrust_overshoot.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/component_set.hpp"
#include "common/model/decay_share.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"coefficient_u", "N/(m/s)", 20.0, -1e4, 1e4},
                                 EffectParameter{"coefficient_v", "N/(m/s)", 20.0, -1e4, 1e4},
                                 EffectParameter{"coefficient_w", "N/(m/s)", 20.0, -1e4, 1e4},
                                 EffectParameter{"coefficient_p", "N m/(rad/s)", 2.0, -1e3, 1e3},
                                 EffectParameter{"coefficient_q", "N m/(rad/s)", 2.0, -1e3, 1e3},
                                 EffectParameter{"coefficient_r", "N m/(rad/s)", 2.0, -1e3, 1e3},
                                 EffectParameter{"time_constant", "s", 3.0, 0.05, 30.0}};
constexpr int kAxes = 6;  // z, and the relative velocity that was felt last, on all axes
constexpr std::size_t kTime = kAxes;

/// Forms after those of one axis are of the axes whose bits are set in what is above kAxes.
bool acts_on(int variant, std::size_t axis) {
  return variant < kAxes ? axis == static_cast<std::size_t>(variant) : in_set(variant - kAxes, axis);
}

class FluidMemory final : public Effect {
 public:
  std::string_view name() const override { return "fluid_memory"; }
  std::string_view sentence() const override { return "The water remembers past motion for a while."; }
  std::string_view revealed_by() const override { return "slow and quick changes between the same speeds"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  int amplitudes() const override { return kAxes; }
  bool feels_motion() const override { return false; }
  bool remembers_motion() const override { return true; }
  bool variants_matter() const override { return true; }
  bool takes_part(int variant, std::size_t number) const override {
    return number == kTime || acts_on(variant, number);
  }
  std::vector<std::string> variants(const Scene& scene) const override {
    std::vector<std::string> names;
    int moving = 0;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      names.emplace_back(scene.vehicle->dof[axis] ? kVelocityNames[axis] : "-");
      if (scene.vehicle->dof[axis]) moving |= 1 << axis;
    }
    if (std::ranges::count(scene.vehicle->dof, true) > 1) {
      names.resize(static_cast<std::size_t>(kAxes + moving), "-");
      names.emplace_back("all axes");
    }
    return names;
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    std::vector<double> start(kTime + 1, 0.0);
    for (std::size_t axis = 0; axis < kTime; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      if (acts_on(variant, axis))
        start[axis] = 0.2 * std::max(scene.tau_rms[a], 1e-3) / std::max(scene.nu_rms[a], 1e-2);
    }
    std::vector<std::vector<double>> starts;
    for (const double time_constant : {0.4, 1.5, 6.0}) {
      start[kTime] = time_constant;
      starts.push_back(start);
    }
    return starts;
  }
  int state_size(const Vehicle&, int) const override { return 2 * kAxes; }
  double run_in(EffectTheta theta) const override { return run_in_for(theta[kTime]); }

  void settle(const Motion& motion, EffectTheta, int, std::span<double> z) const override {
    const Vector6d nu_r = motion.nu_r();
    std::ranges::copy(nu_r, z.begin());
    std::ranges::copy(nu_r, z.begin() + kAxes);
  }
  void advance(const Motion& motion, EffectTheta theta, int, double dt, std::span<double> z) const override {
    thread_local DecayShare decay;
    const double share = decay(dt, theta[kTime]);
    const Vector6d nu_r = motion.nu_r();
    for (std::size_t i = 0; i < kAxes; ++i) {
      // The motion is that of the step's end; with the one before, its middle: exact to second order.
      const double now = nu_r[static_cast<Eigen::Index>(i)];
      z[i] += share * (0.5 * (now + z[kAxes + i]) - z[i]);
      z[kAxes + i] = now;
    }
  }
  void feel(Motion& motion, EffectTheta theta, int variant, std::span<const double> z) const override {
    for (std::size_t i = 0; i < kAxes; ++i) {
      if (acts_on(variant, i)) motion.w_memory[static_cast<Eigen::Index>(i)] -= theta[i] * z[i];
    }
  }
};

}  // namespace

const Effect& fluid_memory() {
  static const FluidMemory kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

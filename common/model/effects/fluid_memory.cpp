// Physics: the water remembers past motion (shed vortices, surface waves): a force that follows velocity late,
//   mu_i = -k z_i,  T z_dot_i = nu_r,i - z_i,   that is  -int K(t - s) nu_r(s) ds  with K = k/T exp(-t/T)
// (Cummins 1962; one term of the state-space form in Fossen 2011, sec. 5.4.2). k > 0 takes energy at every frequency.
// k may be negative beside a linear drag: drag then grows with frequency instead of falling. Forms: one axis alone, or
// all axes that move, each in proportion to the drag that the vehicle file states or implies; k is then that of the
// first one. Ignores: more than one time constant, coupling between axes. Revealed by the same speeds reached slowly
// and quickly. Confused with linear drag (motions slower than T), added mass (faster ones) and thrust_overshoot.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/effect.hpp"
#include "common/model/parameters.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"coefficient", "N/(m/s)", 20.0, -1e4, 1e4},
                                 EffectParameter{"time_constant", "s", 3.0, 0.05, 30.0}};
constexpr std::size_t kAxes = 6;   // z, the relative velocity that was felt last, each axis' share of k on all axes
constexpr double kOrdinary = 0.5;  // m/s, rad/s: speed at which drags are compared
constexpr int kAll = kAxes;        // the form after those of one axis

/// Drag of each moving axis over that of the first one; zero where nothing is stated.
Vector6d shares(const Vehicle& vehicle) {
  Vector6d drag = Vector6d::Zero();
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    const auto parameter = parameter_from_name(vehicle.parameters[i]);
    if (!parameter || *parameter < BaseParameter::X_u || *parameter > BaseParameter::N_rr) continue;
    const bool quadratic = *parameter >= BaseParameter::X_uu;
    const int on = axis(*parameter);
    if (vehicle.dof[static_cast<std::size_t>(on)])
      drag[on] += std::abs(vehicle.priors[i].mean) * (quadratic ? kOrdinary : 1.0);
  }
  const auto first = std::ranges::find_if(drag, [](double d) { return d > 0.0; });
  return first == drag.end() ? drag : drag / *first;
}

class FluidMemory final : public Effect {
 public:
  std::string_view name() const override { return "fluid_memory"; }
  std::string_view sentence() const override { return "The water remembers past motion for a while."; }
  std::string_view revealed_by() const override { return "slow and quick changes between the same speeds"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  int amplitudes() const override { return 1; }
  bool feels_motion() const override { return false; }
  bool variants_matter() const override { return true; }
  std::string_view unit(int variant, std::size_t number) const override {
    return number == 0 ? drag_unit(variant % kAll, variant % kAll, 1) : kParameters[number].unit;
  }
  std::vector<std::string> variants(const Scene& scene) const override {
    std::vector<std::string> names;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      names.emplace_back(scene.vehicle->dof[axis] ? kVelocityNames[axis] : "-");
    }
    const Vector6d share = shares(*scene.vehicle);
    const bool can = (share.head<3>().array() > 0.0).any() && (share.array() > 0.0).count() > 1;
    names.emplace_back(can ? "all axes" : "-");
    return names;
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const Vector6d share = shares(*scene.vehicle);
    const auto axis = variant == kAll ? std::ranges::find_if(share, [](double d) { return d > 0.0; }) - share.begin()
                                      : Eigen::Index{variant};
    const double speed = std::max(scene.nu_rms[axis], 1e-2);
    const double coefficient = 0.2 * std::max(scene.tau_rms[axis], 1e-3) / speed;
    return {{coefficient, 0.4}, {coefficient, 1.5}, {coefficient, 6.0}};
  }
  int state_size(const Vehicle&, int) const override { return 3 * static_cast<int>(kAxes); }
  double run_in(EffectTheta theta) const override { return run_in_for(theta[1]); }

  void settle(const Motion& motion, EffectTheta, std::span<double> z) const override {
    const Vector6d nu_r = motion.nu_r(), share = shares(*motion.vehicle);
    std::ranges::copy(nu_r, z.begin());
    std::ranges::copy(nu_r, z.begin() + kAxes);
    std::ranges::copy(share, z.begin() + 2 * kAxes);
  }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
    const double share = theta[1] > 0.0 ? -std::expm1(-dt / theta[1]) : 1.0;
    const Vector6d nu_r = motion.nu_r();
    for (std::size_t i = 0; i < kAxes; ++i) {
      // The motion is that of the step's end; with the one before, its middle: exact to second order.
      const double now = nu_r[static_cast<Eigen::Index>(i)];
      z[i] += share * (0.5 * (now + z[kAxes + i]) - z[i]);
      z[kAxes + i] = now;
    }
  }
  void feel(Motion& motion, EffectTheta theta, int variant, std::span<const double> z) const override {
    if (variant == kAll) {
      for (std::size_t i = 0; i < kAxes; ++i)
        motion.w_memory[static_cast<Eigen::Index>(i)] -= theta[0] * z[2 * kAxes + i] * z[i];
    } else {
      motion.w_memory[variant] -= theta[0] * z[static_cast<std::size_t>(variant)];
    }
  }
};

}  // namespace

const Effect& fluid_memory() {
  static const FluidMemory kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

// Physics: the water remembers past motion (shed vortices, surface waves): a force that follows velocity late,
//   mu_i = -k z_i,  T z_dot_i = nu_r,i - z_i,   that is  -int K(t - s) nu_r(s) ds  with K = k/T exp(-t/T)
// (Cummins 1962; one term of the state-space form in Fossen 2011, sec. 5.4.2). k > 0 takes energy at every frequency.
// k may be negative beside a linear drag: drag then grows with frequency instead of falling. Swinging, as waves that a
// hull has made and eddies that it sheds come back to it: z is the real part of a complex one,
//   z_dot_i = nu_r,i / T - (1/T - j omega) z_i,   K = k/T exp(-t/T) cos(omega t)
// (one pair of poles of the same state-space form), which takes energy at every frequency too. Forms: one axis alone,
// or all axes that move, each with a k of its own and one time constant (and one omega) for all: vortices and waves of
// one hull last alike, and how much of each axis' drag they are no file knows. Ignores: more than one time constant,
// coupling between axes. Revealed by the same speeds reached slowly and quickly. Confused with linear drag (motions
// slower than T), added mass (faster ones) and thrust_overshoot.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "common/model/component_set.hpp"
#include "common/model/decay_share.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kFluidMemoryParameters{EffectParameter{"coefficient_u", "N/(m/s)", 20.0, -1e4, 1e4},
                                            EffectParameter{"coefficient_v", "N/(m/s)", 20.0, -1e4, 1e4},
                                            EffectParameter{"coefficient_w", "N/(m/s)", 20.0, -1e4, 1e4},
                                            EffectParameter{"coefficient_p", "N m/(rad/s)", 2.0, -1e3, 1e3},
                                            EffectParameter{"coefficient_q", "N m/(rad/s)", 2.0, -1e3, 1e3},
                                            EffectParameter{"coefficient_r", "N m/(rad/s)", 2.0, -1e3, 1e3},
                                            EffectParameter{"time_constant", "s", 3.0, 0.05, 30.0},
                                            EffectParameter{"natural_frequency", "rad/s", 1.0, 0.0, 6.0}};
constexpr int kAxes = 6;  // z, the relative velocity that was felt last, and the imaginary part of z, on all axes
constexpr std::size_t kTime = kAxes, kFrequency = kTime + 1;
constexpr int kSwinging = kAxes + 64;  // first of the forms that swing; they follow in the order of the others

bool swings(int variant) { return variant >= kSwinging; }

/// Forms after those of one axis are of the axes whose bits are set in what is above kAxes.
bool acts_on(int variant, std::size_t axis) {
  const int of = variant % kSwinging;
  return of < kAxes ? axis == static_cast<std::size_t>(of) : in_set(of - kAxes, axis);
}

using Complex = std::complex<double>;

/// What a steady velocity of one leaves in the memory.
Complex steady(EffectTheta theta) { return 1.0 / Complex{1.0, -theta[kFrequency] * theta[kTime]}; }

/// exp(-(1/T - j omega) dt), worked out anew when one of the three has changed.
class Turn {
 public:
  Complex operator()(double dt, EffectTheta theta) {
    if (dt != dt_ || theta[kTime] != time_constant_ || theta[kFrequency] != frequency_) {
      dt_ = dt;
      time_constant_ = theta[kTime];
      frequency_ = theta[kFrequency];
      turn_ = std::exp(Complex{-dt / time_constant_, frequency_ * dt});
    }
    return turn_;
  }

 private:
  double dt_{}, time_constant_{}, frequency_{};
  Complex turn_;
};

class FluidMemory final : public Effect {
 public:
  std::string_view name() const override { return "fluid_memory"; }
  std::string_view sentence() const override { return "The water remembers past motion for a while."; }
  std::string_view revealed_by() const override { return "slow and quick changes between the same speeds"; }
  std::span<const EffectParameter> parameters() const override { return kFluidMemoryParameters; }
  int amplitudes() const override { return kAxes; }
  bool feels_motion() const override { return false; }
  bool remembers_motion() const override { return true; }
  bool variants_matter() const override { return true; }
  bool takes_part(int variant, std::size_t number) const override {
    if (number == kFrequency) return swings(variant);
    return number == kTime || acts_on(variant, number);
  }
  bool rules_out(int variant, int other) const override { return variant % kSwinging == other % kSwinging; }
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
    const std::vector<std::string> plain = names;
    names.resize(kSwinging, "-");
    for (const std::string& name : plain) names.push_back(name == "-" ? name : name + ", swinging");
    return names;
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    std::vector<double> start(kFrequency + 1, 0.0);
    for (std::size_t axis = 0; axis < kTime; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      if (acts_on(variant, axis))
        start[axis] = 0.2 * std::max(scene.tau_rms[a], 1e-3) / std::max(scene.nu_rms[a], 1e-2);
    }
    std::vector<std::vector<double>> starts;
    if (!swings(variant)) {
      for (const double time_constant : {0.4, 1.5, 6.0}) {
        start[kTime] = time_constant;
        starts.push_back(start);
      }
      return starts;
    }
    for (const double time_constant : {1.0, 3.0}) {
      for (const double frequency : {0.4, 1.2}) {
        start[kTime] = time_constant;
        start[kFrequency] = frequency;
        starts.push_back(start);
      }
    }
    return starts;
  }
  int state_size(const Vehicle&, int) const override { return 3 * kAxes; }
  double run_in(EffectTheta theta) const override { return run_in_for(theta[kTime]); }

  void settle(const Motion& motion, EffectTheta theta, int variant, std::span<double> z) const override {
    const Vector6d nu_r = motion.nu_r();
    std::ranges::copy(nu_r, z.begin());
    std::ranges::copy(nu_r, z.begin() + kAxes);
    if (!swings(variant)) return;
    const Complex share = steady(theta);
    for (std::size_t i = 0; i < kAxes; ++i) {
      z[i] = share.real() * nu_r[static_cast<Eigen::Index>(i)];
      z[2 * kAxes + i] = share.imag() * nu_r[static_cast<Eigen::Index>(i)];
    }
  }
  void advance(const Motion& motion, EffectTheta theta, int variant, double dt, std::span<double> z) const override {
    if (swings(variant)) return turn(motion, theta, dt, z);
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

 private:
  static void turn(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) {
    thread_local Turn turn_in;
    const Complex turned = turn_in(dt, theta), fresh = (1.0 - turned) * steady(theta);
    const Vector6d nu_r = motion.nu_r();
    for (std::size_t i = 0; i < kAxes; ++i) {
      const double now = nu_r[static_cast<Eigen::Index>(i)];
      const Complex next = turned * Complex{z[i], z[2 * kAxes + i]} + fresh * (0.5 * (now + z[kAxes + i]));
      z[i] = next.real();
      z[2 * kAxes + i] = next.imag();
      z[kAxes + i] = now;
    }
  }
};

}  // namespace

const Effect& fluid_memory() {
  static const FluidMemory kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects

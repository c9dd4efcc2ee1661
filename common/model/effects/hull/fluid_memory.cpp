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
#include <bit>
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

/// A memory on the axes of a set, alone or all that move.
class WaterRemembers : public OneOfMany {
 public:
  WaterRemembers(int axes, bool alone, NumberSet shape, int thing)
      : OneOfMany{{.sought = with_axes(shape, axes), .obeys = thing}}, axes_{axes}, alone_{alone} {}
  int state_size(int) const override { return 3 * kAxes; }
  double run_in(EffectTheta theta) const override { return run_in_for(theta[kTime]); }
  void settle(const Motion& motion, EffectTheta, std::span<double> z) const override {
    const Vector6d nu_r = motion.nu_r();
    std::ranges::copy(nu_r, z.begin());
    std::ranges::copy(nu_r, z.begin() + kAxes);
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double> z) const override {
    for (std::size_t i = 0; i < kAxes; ++i) {
      if (in_set(axes_, i)) motion.w_memory[static_cast<Eigen::Index>(i)] -= theta[i] * z[i];
    }
  }

 protected:
  [[nodiscard]] FormName name_with(const Scene& scene, const char* manner) const {
    int moving = 0;
    for (std::size_t axis = 0; axis < kAxes; ++axis) moving |= scene.vehicle->dof[axis] ? 1 << axis : 0;
    if (!alone_)
      return when(axes_ == moving && std::popcount(static_cast<unsigned>(moving)) > 1,
                  std::string{"all axes"} + manner);
    const auto axis = static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(axes_)));
    return when(scene.vehicle->dof[axis], std::string{kVelocityNames[axis]} + manner);
  }
  [[nodiscard]] std::vector<double> start(const Scene& scene) const {
    std::vector<double> start(kFrequency + 1, 0.0);
    for (std::size_t axis = 0; axis < kTime; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      if (in_set(axes_, axis)) start[axis] = 0.2 * std::max(scene.tau_rms[a], 1e-3) / std::max(scene.nu_rms[a], 1e-2);
    }
    return start;
  }

 private:
  static NumberSet with_axes(NumberSet numbers, int axes) {
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      if (in_set(axes, axis)) numbers.add(axis);
    }
    return numbers;
  }

  int axes_;
  bool alone_;
};

class FadingMemory final : public WaterRemembers {
 public:
  FadingMemory(int axes, bool alone, int thing) : WaterRemembers{axes, alone, {kTime}, thing} {}
  FormName name(const Scene& scene) const override { return name_with(scene, ""); }
  Starts starts(const Scene& scene) const override {
    std::vector<double> one = start(scene);
    Starts starts;
    for (const double time_constant : {0.4, 1.5, 6.0}) {
      one[kTime] = time_constant;
      starts.push_back(one);
    }
    return starts;
  }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
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
};

class SwingingMemory final : public WaterRemembers {
 public:
  SwingingMemory(int axes, bool alone, int thing) : WaterRemembers{axes, alone, {kTime, kFrequency}, thing} {}
  FormName name(const Scene& scene) const override { return name_with(scene, ", swinging"); }
  Starts starts(const Scene& scene) const override {
    std::vector<double> one = start(scene);
    Starts starts;
    for (const double time_constant : {1.0, 3.0}) {
      for (const double frequency : {0.4, 1.2}) {
        one[kTime] = time_constant;
        one[kFrequency] = frequency;
        starts.push_back(one);
      }
    }
    return starts;
  }
  void settle(const Motion& motion, EffectTheta theta, std::span<double> z) const override {
    WaterRemembers::settle(motion, theta, z);
    const Vector6d nu_r = motion.nu_r();
    const Complex share = steady(theta);
    for (std::size_t i = 0; i < kAxes; ++i) {
      z[i] = share.real() * nu_r[static_cast<Eigen::Index>(i)];
      z[2 * kAxes + i] = share.imag() * nu_r[static_cast<Eigen::Index>(i)];
    }
  }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
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

/// Of each axis, then of each set of axes; those that swing in the same order behind them. The two laws of the same
/// axes exclude each other.
template <class F>
void add_each(Forms& all) {
  int thing = 0;
  for (std::size_t axis = 0; axis < kAxes; ++axis) all.push_back(std::make_unique<F>(1 << axis, true, thing++));
  for (int axes = 0; axes < 1 << kAxes; ++axes) all.push_back(std::make_unique<F>(axes, false, thing++));
}

Forms fading_and_swinging() {
  Forms all;
  add_each<FadingMemory>(all);
  add_each<SwingingMemory>(all);
  return all;
}

}  // namespace

const Effect& fluid_memory() {
  static const Effect kEffect{{.name = "fluid_memory",
                               .sentence = "The water remembers past motion for a while.",
                               .revealed_by = "slow and quick changes between the same speeds",
                               .stage = Stage::kBody,
                               .amplitudes = kAxes,
                               .forms_coexist = true,
                               .feels_motion = false,
                               .remembers_motion = true,
                               .takes_energy = true},
                              kFluidMemoryParameters,
                              fading_and_swinging()};
  return kEffect;
}

}  // namespace fathom::model::effects

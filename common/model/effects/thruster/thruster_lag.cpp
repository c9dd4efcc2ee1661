// Physics: propeller and water need time to reach the new thrust: first order, T f_dot = f_c - f (Fossen 2011,
// sec. 12.3). Forms: for all thrusters alike; T + dT for those that push up and down, which are often of another make
// (thruster_kinds.hpp); or it is the shaft that needs time, whose speed thrust goes with the square of: T n_dot = n_c -
// n, f = n |n| (a regulated motor; Blanke et al. 2000). Thrust then starts slowly, and falls quickly when the shaft
// stops; a reversal lingers at nothing; or second order: motor and water one after the other, T each (Healey et al.
// 1995), which starts with no slope; or a motor whose torque is commanded, against the water's: 2 sqrt(f_r) T n_dot =
// f_c - n |n| (Yoerger, Cooke, Slotine 1990), quick at large thrust and slow at small, T its time constant at f_r, the
// largest thrust that the vehicle file states (10 N where it states none). Ignores: two refinements at once. Revealed
// by reversals at frequencies near 1/T, the law by steps up and down of several sizes. Confused with thruster_delay
// and, over a narrow band, with added mass.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/decay_share.hpp"
#include "common/model/effect_size.hpp"
#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrusterLagParameters{
    EffectParameter{
        .name = "time_constant", .unit = "s", .sigma = 0.15, .low = 0.0, .high = 3.0, .after_command = true},
    EffectParameter{"vertical_longer", "s", 0.15, -3.0, 3.0}};
constexpr double kReferenceThrust = 10.0;  // N, where none is stated
constexpr double kInstant = 1e-6;          // s

/// s. What two kinds differ by is zero in the other forms.
double of_vertical(EffectTheta theta) { return time_of_vertical(theta[0], theta[1]); }
/// Shaft speed of a force, up to a factor that plays no part.
double shaft(double force) { return std::copysign(std::sqrt(std::abs(force)), force); }

/// Shaft speed after dt of n_dot = (f_c - n |n|) / c, exactly for a force that is held. A shaft that turns the other
/// way is stopped by motor and water together, n = a tan(...), and then turns as one from rest, n = a tanh(...).
double turned(double n, double force, double dt_over_c) {
  if (force == 0.0) return n / (1.0 + std::abs(n) * dt_over_c);
  const double side = std::copysign(1.0, force), a = std::sqrt(std::abs(force));
  double left = a * dt_over_c;
  n *= side;
  if (n < 0.0) {
    const double until_rest = std::atan(-n / a);
    if (left < until_rest) return side * a * std::tan(left - until_rest);
    left -= until_rest;
    n = 0.0;
  }
  const double share = std::tanh(left);
  return side * a * (n + a * share) / (a + n * share);
}

double reference_thrust(const Vehicle& vehicle) {
  return vehicle.largest_thrust > 0.0 ? vehicle.largest_thrust : kReferenceThrust;
}

/// Thrust of each or, where it is the shaft that lags, its speed; behind it, thrust that follows the first.
class Lag : public Form {
 public:
  explicit Lag(NumberSet sought = {0}) : Form{{.sought = sought}} {}
  Starts starts(const Scene& scene) const override { return shares_of_typical_lag(scene, 1.0); }
  int state_size(int actuators) const final { return 2 * actuators; }
  /// The last takes longer to forget, and a shaft moved by torque slows down as it comes to rest.
  double run_in(EffectTheta theta) const final { return run_in_for(1.5 * std::max(theta[0], of_vertical(theta))); }
  void settle(const Motion& motion, EffectTheta, std::span<double> z) const override {
    const std::size_t n = z.size() / 2;
    for (std::size_t i = 0; i < n; ++i) z[i] = z[n + i] = motion.force[static_cast<Eigen::Index>(i)];
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double> z) const final {
    if (theta[0] <= 0.0 && of_vertical(theta) <= 0.0) return;
    const std::size_t n = z.size() / 2;
    for (std::size_t i = 0; i < n; ++i) motion.force[static_cast<Eigen::Index>(i)] = thrust(z[i], z[n + i]);
  }

 protected:
  /// N, of what is remembered of a thruster.
  [[nodiscard]] virtual double thrust(double first, double /*second*/) const { return first; }
  static Starts shares_of_typical_lag(const Scene& scene, double each) {
    const double slower = size_factor(*scene.vehicle, "s");
    return {{0.08 * each * slower, 0.0}, {0.3 * each * slower, 0.0}, {0.9 * each * slower, 0.0}};
  }
};

class FirstOrder final : public Lag {
 public:
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
    thread_local DecayShare decay;
    const double share = decay(dt, theta[0]);
    for (std::size_t i = 0; i < z.size() / 2; ++i) z[i] += share * (motion.force[static_cast<Eigen::Index>(i)] - z[i]);
  }
};

class TwoKinds final : public Lag {
 public:
  TwoKinds() : Lag{{0, 1}} {}
  FormName name(const Scene& scene) const override { return when(has_both_kinds(scene), "vertical thrusters apart"); }
  Starts starts(const Scene& scene) const override {
    const double slower = size_factor(*scene.vehicle, "s");
    return {{0.1 * slower, 0.3 * slower}, {0.4 * slower, -0.3 * slower}};
  }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
    thread_local DecayShare decay, vertical_decay;
    const double share = decay(dt, theta[0]), of_others = vertical_decay(dt, of_vertical(theta));
    for (std::size_t i = 0; i < z.size() / 2; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const bool vertical = is_vertical(*motion.vehicle, k, motion.force.size());
      z[i] += (vertical ? of_others : share) * (motion.force[k] - z[i]);
    }
  }
};

class SecondOrder final : public Lag {
 public:
  FormName name(const Scene&) const override { return "second order"; }
  Starts starts(const Scene& scene) const override { return shares_of_typical_lag(scene, 0.5); }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
    thread_local DecayShare decay;
    const double share = decay(dt, theta[0]);
    const double passed_on = theta[0] > 0.0 ? dt / theta[0] * (1.0 - share) : 0.0;
    const std::size_t n = z.size() / 2;
    for (std::size_t i = 0; i < n; ++i) {  // exact for a force that is held
      const double force = motion.force[static_cast<Eigen::Index>(i)];
      z[n + i] += share * (force - z[n + i]) + passed_on * (z[i] - force);
      z[i] += share * (force - z[i]);
    }
  }

 private:
  double thrust(double, double second) const override { return second; }
};

/// The shaft's speed is what lags. Of a wrench nobody knows which shafts made it.
class ShaftLag : public Lag {
 public:
  void settle(const Motion& motion, EffectTheta, std::span<double> z) const final {
    const std::size_t n = z.size() / 2;
    for (std::size_t i = 0; i < n; ++i) z[i] = z[n + i] = shaft(motion.force[static_cast<Eigen::Index>(i)]);
  }

 private:
  double thrust(double speed, double) const final { return speed * std::abs(speed); }
};

class RegulatedShaft final : public ShaftLag {
 public:
  FormName name(const Scene& scene) const override { return when(!scene.input_is_wrench, "shaft speed"); }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
    thread_local DecayShare decay;
    const double share = decay(dt, theta[0]);
    for (std::size_t i = 0; i < z.size() / 2; ++i)
      z[i] += share * (shaft(motion.force[static_cast<Eigen::Index>(i)]) - z[i]);
  }
};

class CommandedTorque final : public ShaftLag {
 public:
  FormName name(const Scene& scene) const override { return when(!scene.input_is_wrench, "torque"); }
  void advance(const Motion& motion, EffectTheta theta, double dt, std::span<double> z) const override {
    const double dt_over_c = dt / (2.0 * std::sqrt(reference_thrust(*motion.vehicle)) * std::max(theta[0], kInstant));
    for (std::size_t i = 0; i < z.size() / 2; ++i)
      z[i] = turned(z[i], motion.force[static_cast<Eigen::Index>(i)], dt_over_c);
  }
};

}  // namespace

const Effect& thruster_lag() {
  static const Effect kEffect{{.name = "thruster_lag",
                               .sentence = "Thrust builds up gradually after each change of command.",
                               .revealed_by = "steps and a sweep of thrust up to about 2 Hz",
                               .finding = "Thrust follows its command with a time constant of {time_constant}",
                               .stage = Stage::kThrust,
                               .feels_motion = false},
                              kThrusterLagParameters,
                              forms(FirstOrder{}, TwoKinds{}, RegulatedShaft{}, SecondOrder{}, CommandedTorque{})};
  return kEffect;
}

}  // namespace fathom::model::effects

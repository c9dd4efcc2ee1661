// What the vehicle feels at one instant. Effects read it and alter it; the dynamics turn it into an acceleration.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "common/base/spatial.hpp"

namespace fathom::model {

constexpr int kMaxActuators = 16;
using ActuatorForces = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxActuators, 1>;            ///< N each
using Allocation = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxActuators>;  ///< tau = B f

/// Velocities at samples of equal distance in time, one column per sample: u v w [m/s], p q r [rad/s].
using VelocityTrace = Eigen::Matrix<double, 6, Eigen::Dynamic>;
/// A trace wherever its numbers lie in memory.
using VelocityView = Eigen::Ref<VelocityTrace, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;

struct Vehicle;

/// How forces act between the times at which they were told.
struct InputTiming {
  /// Share of the time between inputs by which they act later than straight lines between them: 1/2 where each is held
  /// until the next one, -1/2 where each tells of the time since the one before.
  double hold{0.0};
  double step{0.0};      ///< s between inputs
  bool averaged{false};  ///< inputs came faster than the grid: what lies between held and told is a mixture of both
};

/// The actuators' commanded forces over time; those of the first sample before it, of the last one after it.
class InputSignal {
 public:
  InputSignal() = default;
  /// `samples` on a uniform grid: samples[k] holds at `t0 + k dt` [s]. `held`, `told`: those of a Trial, made of the
  /// samples when empty.
  InputSignal(double t0, double dt, std::span<const Eigen::VectorXd> samples,
              std::span<const Eigen::VectorXd> held = {}, std::span<const Eigen::VectorXd> told = {},
              const InputTiming& timing = {});
  /// All of it acts so much later than it was told, s: two clocks, and how inputs are held.
  void act_later(double seconds) { offset_ = seconds; }
  /// Straight lines, early or late as the timing says: continuous in time.
  void at(double t, ActuatorForces& force) const;
  /// With the jumps of inputs that are held.
  void now(double t, ActuatorForces& force) const;
  /// The same as it was `later` seconds before: the mean over the time that now() has one force for, so that no jump is
  /// lost between the instants that are asked for.
  void ago(double t, double later, ActuatorForces& force) const;
  /// When the first sample holds, s.
  [[nodiscard]] double begins() const { return t0_; }
  /// By how much the force changes over a step of the grid about t, jumps apart [N].
  void change(double t, ActuatorForces& difference) const;

 private:
  void line(double t, ActuatorForces& force) const;
  [[nodiscard]] double place(double t) const;
  void mixture(double place, ActuatorForces& force) const;

  double t0_{0.0};
  double dt_{1.0};
  double later_{0.0};       // s
  double offset_{0.0};      // s: of the clock of the inputs
  double ahead_{0.0};       // steps of the grid from the time that is asked for to the step that tells of it
  double held_share_{0.0};  // the rest goes along straight lines, or as told where both are mixed
  double part_{1.0};        // s
  bool mixed_{false};
  std::span<const Eigen::VectorXd> samples_;
  std::span<const Eigen::VectorXd> held_, told_;
};

/// State, environment and forces at time `t`, as felt.
struct Motion {
  double t{};                                     ///< s from the run's start
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};  ///< m, NED
  Eigen::Matrix3d R_WB{Eigen::Matrix3d::Identity()};
  Vector6d nu{Vector6d::Zero()};           ///< B in W, in B: m/s, rad/s
  Vector6d nu_dot_told{Vector6d::Zero()};  ///< m/s^2, rad/s^2: of axes that are not simulated, as measured; else zero
  Eigen::Vector3d v_WF_B{Eigen::Vector3d::Zero()};  ///< m/s, water velocity seen in B; effects add to it
  Eigen::Vector3d a_WF_B{Eigen::Vector3d::Zero()};  ///< m/s^2, acceleration of the water in W, seen in B (waves)
  Vector6d w_memory{Vector6d::Zero()};              ///< N, N m: wrench of what effects remember of past motion
  double m_more{};                                  ///< kg at Bo, besides the model's own
  ActuatorForces force{};                           ///< N, as they reach the water; effects alter it
  double voltage{};                                 ///< V; 0 when not logged
  std::span<const double> columns{};                ///< as Trial::columns has them; empty: none were measured
  const InputSignal* input{};                       ///< commanded forces at other times (delay)
  const Vehicle* vehicle{};

  /// Velocity relative to the water.
  [[nodiscard]] Vector6d nu_r() const {
    Vector6d relative = nu;
    relative.head<3>() -= v_WF_B;
    return relative;
  }
};

/// What an effect adds to the right-hand side, and the inertia it adds on the left.
struct Load {
  Vector6d wrench{Vector6d::Zero()};            ///< N, N m at Bo, body axes
  Vector6d inertia_diagonal{Vector6d::Zero()};  ///< kg, kg m^2: added to the diagonal of M
  bool has_couplings{false};
  Vector6d drag{Vector6d::Zero()};  ///< N, N m: the hull's own by the base parameters, for effects that make it more
  double drag_share{};              ///< how much more of its forces the effects' wrench holds, as a share

  /// Added to M; symmetric. Made when it is asked for: few effects couple axes, and every step begins with none.
  [[nodiscard]] Matrix6d& added_inertia() {
    if (!has_couplings) coupled_.setZero();
    has_couplings = true;
    return coupled_;
  }
  /// A mass at Bo: (m, m, m, 0, 0, 0) nu_dot = -w x m v (Newton-Euler; Fossen 2011, sec. 3.3).
  void add_mass(double mass, const Vector6d& nu) {
    const Eigen::Vector3d v = nu.head<3>(), w = nu.tail<3>();
    wrench.head<3>() -= mass * w.cross(v);
    inertia_diagonal.head<3>().array() += mass;
  }
  [[nodiscard]] bool has_inertia() const { return has_couplings || !inertia_diagonal.isZero(0.0); }
  /// All that is added to M.
  [[nodiscard]] Matrix6d inertia() const {
    Matrix6d all = has_couplings ? coupled_ : Matrix6d{Matrix6d::Zero()};
    all.diagonal() += inertia_diagonal;
    return all;
  }
  void clear() {
    wrench.setZero();
    drag.setZero();
    drag_share = 0.0;
    inertia_diagonal.setZero();
    has_couplings = false;
  }

 private:
  Matrix6d coupled_;
};

}  // namespace fathom::model

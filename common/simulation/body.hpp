// The truth: a rigid body in six degrees of freedom with a vehicle's base model, hidden effects, contacts and a
// battery, integrated by the midpoint rule in steps of fixed length. Thrust is held between two calls of drive().
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "common/model/derivative_motion.hpp"
#include "common/simulation/contact.hpp"
#include "common/simulation/random.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {

/// Open-circuit voltage that falls with time, less what the current through the cells' resistance takes. Current grows
/// with thrust to the power 3/2 (power of an ideal propeller over a constant voltage).
struct BatteryTruth {
  double full{};    ///< V; 0: no battery
  double fall{};    ///< V/s
  double sag{};     ///< V/N^(3/2), per thruster
  double lowest{};  ///< V
};

struct StartPose {
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};            ///< m
  double heading{};                                         ///< rad
  Eigen::Quaterniond tilt{Eigen::Quaterniond::Identity()};  ///< at heading north
};

/// The truth is that of the vehicle file's hydrodynamic derivatives, not of base parameters. The umbilical pulls at
/// random besides: a first-order process of this size and memory; a slack one, of a vehicle at rest, does not.
struct DerivativeTruth {
  double pull{};    ///< N
  double memory{};  ///< s
  std::uint64_t seed{};
};

class Body {
 public:
  /// `truth.vehicle` has all six degrees of freedom and outlives the body. `step` [us].
  Body(model::Model truth, const Hull& hull, const BatteryTruth& battery, const StartPose& start, Utime origin,
       Utime step, const std::optional<DerivativeTruth>& derivatives = std::nullopt);
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;

  /// The run begins at this time; before the first step only.
  void begin_at(Utime origin) { origin_ = origin; }
  /// Forces of the thrusters [N] from now on.
  void drive(const model::ActuatorForces& force);
  void step();
  [[nodiscard]] Utime now() const { return origin_ + count_ * step_; }
  [[nodiscard]] Utime step_length() const { return step_; }
  /// The truth at an instant within the last step (both ends included).
  [[nodiscard]] Moment at(Utime utime) const;
  [[nodiscard]] double voltage() const;
  [[nodiscard]] const ContactCounts& contacts() const { return hull_.counts(); }
  [[nodiscard]] const model::Model& model() const { return truth_; }
  [[nodiscard]] double seconds() const { return static_cast<double>(count_ * step_) * 1e-6; }
  /// Kinetic energy, height and springs [J], of the base model with the effects absent.
  [[nodiscard]] double energy() const;

 private:
  struct State {
    Eigen::Vector3d p{Eigen::Vector3d::Zero()};
    Eigen::Quaterniond q{Eigen::Quaterniond::Identity()};
    Vector6d nu{Vector6d::Zero()};
  };
  [[nodiscard]] model::Motion motion(double t, const State& state) const;
  /// As felt, contacts included. The effects' memory advances by `dt` before.
  void feel(model::Motion& motion, double dt) const;
  void remember(double t);
  void pull(double dt);
  [[nodiscard]] model::Attached attached(const model::Motion& motion) const;
  [[nodiscard]] Vector6d slope(const model::Motion& motion) const;

  model::Model truth_;
  Hull hull_;
  BatteryTruth battery_;
  Utime origin_, step_;
  std::int64_t count_{};
  State before_, now_;
  Vector6d slope_begin_{Vector6d::Zero()}, slope_middle_{Vector6d::Zero()};
  model::ActuatorForces force_;
  mutable std::vector<double> memory_;
  std::vector<Eigen::VectorXd> history_;  ///< forces at past steps, for effects that look back
  std::size_t oldest_{};                  ///< of history_ that still counts
  model::InputSignal input_;
  std::optional<DerivativeTruth> derivatives_;
  RandomStream stream_;
  Eigen::Vector3d process_{Eigen::Vector3d::Zero()}, pull_W_{Eigen::Vector3d::Zero()};  // N
};

}  // namespace fathom::simulation

// The one door between the likelihood and the effects of common/model: where an effect acts (on the thrust, on the
// hull, on what the water remembers, on the sensors), its numbers with priors, and each of these actions. Nothing else
// in this room or above it reads an Effect.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/likelihood/hypothesis.hpp"
#include "common/likelihood/run_data.hpp"

namespace fathom::likelihood {

/// Of the priors of effects' numbers: the density falls with the fourth power, so that a number fifty times as large as
/// ordinary costs some ten nats and not a thousand.
constexpr double kEffectFreedom = 3.0;

enum class Stage {
  kThrust,  ///< by command, time and voltage alone: worked out once for a run
  kHull,    ///< water, wrench and inertia at an instant
  kMemory,  ///< remembers past motion
  kSensor   ///< what the sensors make of the velocities
};

[[nodiscard]] Stage stage_of(const model::ActiveEffect& active);
/// Numbers of the effect that a fit may move, appended.
void add_effect_numbers(const model::Model& model, std::size_t effect, double t_low, double t_high,
                        std::vector<Number>& numbers);

/// Forces of the actuators as they reach the water, at the middle of every substep of a run: column after column. With
/// `offset` [s] they act later.
void thrust_forces(const model::Model& model, const RunData& run, double offset, Eigen::MatrixXd& forces);

/// The hull's effects alter what is felt; loads are the dynamics' business.
void feel_hull(const model::Model& model, model::Motion& motion);
[[nodiscard]] bool has_stage(const model::Model& model, Stage stage);

/// What effects remember of past motion, advanced block by block along the filtered velocities.
class MotionMemory {
 public:
  /// `numbers`: those whose derivatives are wanted. With `columns`, the memory's own sensitivities are carried.
  MotionMemory(const model::Model& model, const std::vector<Number>& numbers);
  [[nodiscard]] bool empty() const { return parts_.empty(); }
  void begin(const model::Motion& motion);
  /// `motion` holds the velocity at the block's end.
  void advance(const model::Motion& motion, double dt);
  /// Of the next block's middle [N, N m].
  [[nodiscard]] const Vector6d& wrench() const { return wrench_; }
  /// Change per unit of number j; nothing where it is no number of a memory.
  [[nodiscard]] const Vector6d* slope(std::size_t j) const;
  /// Wrench that a change of the velocities makes: columns as in `nu_columns` (6 x p), added to `wrenches`.
  void advance_columns(const model::Motion& motion, double dt,
                       const Eigen::Matrix<double, 6, Eigen::Dynamic>& nu_columns,
                       Eigen::Matrix<double, 6, Eigen::Dynamic>& wrenches);

 private:
  struct Copy {  // the effect at its numbers, or with one of them moved
    std::vector<double> theta, z;
    Vector6d now{Vector6d::Zero()}, next{Vector6d::Zero()};
  };
  struct Part {
    const model::ActiveEffect* active{};
    std::size_t size{};
    Copy itself;
    std::vector<Copy> moved;
    std::vector<std::size_t> number;  // of `moved`
    std::vector<double> step;
    std::vector<double> columns;  // size per column
  };
  static void advance(const model::Motion& motion, const Part& part, double dt, Copy& copy);

  std::vector<Part> parts_;
  Vector6d wrench_{Vector6d::Zero()};
  std::vector<Vector6d> slopes_;
  std::vector<int> slope_of_;
};

/// What the sensors show of the velocities.
class SensorStage {
 public:
  explicit SensorStage(const model::Model& model, double dt);
  [[nodiscard]] bool empty() const { return empty_; }
  void begin(const Vector6d& nu);
  void push(const Vector6d& nu);  ///< true velocity at the next sample
  /// Mean of what is shown over the last `samples`.
  [[nodiscard]] Vector6d mean(std::size_t samples, const model::Model& model);
  /// What is shown of a change that stays, linear.
  [[nodiscard]] static Matrix6d slope(const model::Model& model, double dt);

 private:
  bool empty_{true};
  double dt_{};
  model::VelocityTrace trace_, shown_;
};

}  // namespace fathom::likelihood

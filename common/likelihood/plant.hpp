// A hypothesis on one run as accelerations: thrust worked out once, then the acceleration at any velocity, its slope
// with the velocity and its columns with the free numbers. All slopes are differences of the acceleration itself, so
// that whatever a model holds enters the fit by the same door.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/likelihood/effect_stages.hpp"

namespace fathom::likelihood {

using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;

class Plant {
 public:
  /// `with_columns`: derivatives with the numbers will be asked for.
  Plant(const Hypothesis& hypothesis, const std::vector<Number>& numbers, const RunData& run, std::size_t run_index,
        bool with_columns);
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  /// The beginning of the run: memories settle.
  void begin(const Vector6d& nu);
  /// Situation of a substep of a block; `block` must be the one that memories were advanced to.
  void at_substep(std::size_t interval, int substep);
  /// Situation of a block's middle, with its mean thrust.
  void at_middle(std::size_t block);
  /// nu_dot where the plant is; zero on axes that are not simulated.
  [[nodiscard]] Vector6d acceleration(const Vector6d& nu);
  /// What one more effect on the hull would add to `nu_dot`, the acceleration that was asked for last; `inverse`: that
  /// of the inertia there.
  [[nodiscard]] Vector6d added_by(const model::ActiveEffect& effect, const Vector6d& nu_dot, const Matrix6d& inverse);
  /// d acceleration / d nu, at `nu` where it is `nu_dot`; columns of axes that are not simulated stay zero.
  [[nodiscard]] Matrix6d slope(const Vector6d& nu, const Vector6d& nu_dot);
  /// d acceleration / d wrench: the inverse of the inertia.
  [[nodiscard]] Matrix6d inverse_inertia(const Vector6d& nu, const Vector6d& nu_dot);
  /// d acceleration / d numbers, 6 x numbers.
  void columns(std::size_t block, const Vector6d& nu, const Vector6d& nu_dot, Columns& out);
  /// Ends a block: memories and low passes move on with the velocity there.
  void end_block(std::size_t block, const Vector6d& nu);
  /// Sensitivities of the velocity at the block's end pass into the memory: wrenches of the next block, per number.
  void remember_columns(std::size_t block, const Columns& nu_columns, Columns& wrenches);

  [[nodiscard]] bool remembers() const { return !memory_.empty(); }
  [[nodiscard]] const model::Model& model() const { return model_; }
  [[nodiscard]] const RunData& run() const { return run_; }
  /// Mean over every block of what is given at substeps, column after column.
  void mean_over_blocks(const Eigen::MatrixXd& forces, Eigen::MatrixXd& mean) const;
  [[nodiscard]] const Eigen::MatrixXd& mean_forces() const { return mean_; }  ///< actuators x blocks
  /// What features read at a velocity, of the moment that was set; what streams and a mass would do only where it is
  /// asked for.
  [[nodiscard]] FeatureState features_at(const Vector6d& nu, bool with_operators);
  [[nodiscard]] const model::Motion& motion() const { return motion_; }

 private:
  void set(const Interval& interval, double t);
  /// What the free force and the learned features are functions of, of the moment that was set.
  void show_features();
  [[nodiscard]] Vector6d outside_wrench();
  /// At a velocity in the world, with all water that is in the model; nothing remembered yet.
  void feel_at(const Vector6d& nu);
  void feel();

  model::Model model_;
  FreeForce free_;
  RunNumbers own_;
  const std::vector<Number>& numbers_;
  const RunData& run_;
  std::size_t run_index_;
  MotionMemory memory_;
  std::vector<Stage> stages_;            // of the model's effects
  bool feels_{};                         // some hull effect alters what is felt
  bool free_moves_{};                    // some feature goes with the velocity
  bool free_drags_{};                    // some feature acts along the hull's drag
  bool free_streams_{};                  // some feature is a velocity of the water
  bool free_weighs_{};                   // some feature is a mass
  Eigen::MatrixXd forces_, mean_;        // actuators x substeps, x blocks
  std::vector<Eigen::MatrixXd> slopes_;  // of the mean forces, per number that has one
  std::vector<int> slope_of_;            // number -> place in slopes_, -1: none
  model::Motion motion_;
  model::ActuatorForces force_;
  FeatureState features_;
  Eigen::Vector3d v_WF_B_{Eigen::Vector3d::Zero()};  // of the free force's streams, m/s
  Eigen::Vector3d a_WF_B_{Eigen::Vector3d::Zero()};  // m/s^2
  Vector6d free_still_{Vector6d::Zero()};            // features at this place, when they do not go with the velocity
};

}  // namespace fathom::likelihood

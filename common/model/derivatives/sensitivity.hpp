// The variational equation of a rollout: how its state moves with the base parameters and with the initial velocity.
#pragma once

#include <vector>

#include "common/model/rollout.hpp"

namespace fathom::model {

class Rollout;
struct StepShares;

/// The middle of a rollout's step, where its derivatives are taken.
struct StepMiddle {
  std::size_t from{};  ///< sample before the step
  double offset{};     ///< s after it
  const Eigen::Vector3d& p;
  const Eigen::Quaterniond& q;
  const Vector6d& nu;
  const Vector6d& nu_dot;
  const Vector6d& decay;     ///< rates of decay that the step itself uses, 1/s
  const Vector6d& nu_begin;  ///< at the step's start, where the decay was taken
  const Vector6d& nu_dot_begin;
  const StepShares& shares;  ///< of the step
};

/// S = d(state)/d(columns), state error = [position 3 in W; rotation 3 in B; velocity 6], S_dot = A S + B.
/// A is analytic for the base model; effects add theirs by differences. B comes from the regressor, since the model is
/// linear in its base parameters. What effects remember of motion moves with the columns too, by their own rule.
class Sensitivity {
 public:
  explicit Sensitivity(VelocityDerivatives& out) : out_{out} {}

  void begin(const Model& model, std::size_t samples);
  /// One midpoint step of `h` seconds. The rollout's motion must be the one felt at the middle.
  void advance(Rollout& rollout, const StepMiddle& middle, double h);
  /// Writes the velocity's derivatives of sample k.
  void record(std::size_t k);

 private:
  static constexpr int kColumns = kBaseParameterCount + 6;
  using State = Eigen::Matrix<double, 12, kColumns, Eigen::RowMajor>;
  using Dynamics = Eigen::Matrix<double, 12, 12>;
  using Input = Eigen::Matrix<double, 6, kBaseParameterCount, Eigen::RowMajor>;

  using Wrenches = Eigen::Matrix<double, 6, kColumns>;
  /// Derivatives of what one effect remembers: `size` numbers for each column.
  struct Remembered {
    const ActiveEffect* active{};
    std::size_t size{};
    std::vector<double> z;
  };

  [[nodiscard]] Input input(const Model& model, const Motion& motion, const Vector6d& nu_dot) const;
  void remember(const Motion& motion, const State& state, double dt, Wrenches& wrenches);
  void velocity_rows_by_differences(Rollout& rollout, const StepMiddle& middle, Dynamics& A) const;
  void velocity_rows(const Model& model, const Motion& motion, const Vector6d& nu_dot, Dynamics& A) const;
  [[nodiscard]] Eigen::Matrix<double, 6, kColumns> decay_rows(const Model& model, const StepMiddle& middle) const;
  void slope(const Dynamics& A, const Input& B, const State& state, State& out) const;

  VelocityDerivatives& out_;
  State state_{State::Zero()};
  bool place_matters_{false};  ///< otherwise position's derivatives are not needed
  bool motion_felt_{false};    ///< some feel() depends on the motion
  std::vector<Remembered> remembered_;
  std::vector<Eigen::Index> moving_;  ///< columns of what the vehicle has, for what is remembered
};

}  // namespace fathom::model

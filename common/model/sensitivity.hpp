// The variational equation of a rollout: how its state moves with the base parameters and with the initial velocity.
#pragma once

#include "common/model/rollout.hpp"

namespace fathom::model {

class Rollout;

/// S = d(state)/d(columns), state error = [position 3 in W; rotation 3 in B; velocity 6], S_dot = A S + B.
/// A by differences of the felt acceleration, so that every effect is in it; B from the regressor, since the model is
/// linear in its base parameters.
class Sensitivity {
 public:
  explicit Sensitivity(VelocityDerivatives& out) : out_{out} {}

  void begin(const Vehicle& vehicle, std::size_t samples);
  /// One midpoint step of `h` seconds; the arguments are the state at its middle, the acceleration there,
  /// and the rates of decay that the step itself uses.
  void advance(Rollout& rollout, std::size_t from, double offset, const Eigen::Vector3d& p, const Eigen::Quaterniond& q,
               const Vector6d& nu, const Vector6d& nu_dot, const Vector6d& decay, double h);
  /// Writes the velocity's derivatives of sample k.
  void record(std::size_t k);

 private:
  static constexpr int kColumns = kBaseParameterCount + 6;
  using State = Eigen::Matrix<double, 12, kColumns>;
  using Dynamics = Eigen::Matrix<double, 12, 12>;

  [[nodiscard]] Eigen::Matrix<double, 6, kBaseParameterCount> input(Rollout& rollout, std::size_t from, double offset,
                                                                    const Eigen::Vector3d& p,
                                                                    const Eigen::Quaterniond& q, const Vector6d& nu,
                                                                    const Vector6d& nu_dot) const;

  VelocityDerivatives& out_;
  State state_{State::Zero()};
};

}  // namespace fathom::model

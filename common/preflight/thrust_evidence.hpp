// How well acceleration follows thrust, by linear regression: quick enough to ask a thousand arrangements of thrusters.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "common/model/vehicle.hpp"
#include "common/samples/trial.hpp"

namespace fathom::preflight {

/// Measured accelerations (slopes over half a second) of every moving axis and what stood beside them: each input, and
/// the terms of the base model that are linear in its numbers, whatever these are.
class ThrustEvidence {
 public:
  ThrustEvidence(const model::Vehicle& vehicle, std::span<const Trial> trials);

  /// Minus the log likelihood of the accelerations, up to a constant, if the wrench is `allocation` (6 x inputs) times
  /// the inputs. Thrust accelerates forwards or not at all; noise of every axis as large as it shows.
  [[nodiscard]] double cost(const Eigen::Matrix<double, 6, Eigen::Dynamic>& allocation) const;

 private:
  struct Axis {
    double rows{};
    double square{};         ///< of the acceleration that the base terms leave, summed
    Eigen::MatrixXd inputs;  ///< products of the inputs with one another, base terms taken out
    Eigen::VectorXd both;    ///< their products with the acceleration
  };
  std::array<Axis, 6> axes_;
};

}  // namespace fathom::preflight

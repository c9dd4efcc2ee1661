// What is possible at best: the prediction error of the true simulator, that of the base model's best fit, and the
// Cramer-Rao bound of the base numbers.
#pragma once

#include "test/sealed/dives/sealed_set.hpp"

namespace fathom::sealed {

/// 5 s open-loop errors on validation data, RMS over the standard deviation of the motion, mean over the driven axes.
struct Floor {
  double truth{};                       ///< true structure, true numbers, and the noise of the instruments
  double base{};                        ///< the base model's best fit to noise-free accelerations
  Vector6 truth_rmse{Vector6::Zero()};  ///< m/s, rad/s
};
[[nodiscard]] Floor prediction_floor(const SealedSet& set);

/// Standard deviations that no unbiased fit can beat, per base number.
struct Bound {
  Eigen::VectorXd speeds;  ///< from u v w p q r over windows of 10 s that begin at unknown speeds, poses as they were
  Eigen::VectorXd all;     ///< from every signal over windows of 30 s that begin in an unknown state
};
[[nodiscard]] Bound cramer_rao(const SealedSet& set);

}  // namespace fathom::sealed

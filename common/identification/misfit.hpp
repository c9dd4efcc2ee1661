// What the model has lacked so far, as far as its residual shows it, and what that may have done to the parameters.
// Noise averages out, a term that is missing does not: the estimate goes on being bent by it, however long the trial.
#pragma once

#include <array>

#include "common/base/spatial.hpp"
#include "common/identification/rows.hpp"

namespace fathom::identification {

class Misfit {
 public:
  struct State {
    Vector6d excess{Vector6d::Zero()};           ///< squares of residuals beyond what the noise makes of them
    std::array<ParameterVector, 6> information;  ///< of each axis's rows, sum of h^2 / variance
  };

  explicit Misfit(Eigen::Index parameters);
  /// `square` of the row's residual over its variance; `fails`: the axis does not pass its test at present.
  void take(const Row& row, double square, bool fails);
  void forget(double keep);

  /// Zero where the test has never failed.
  [[nodiscard]] const Vector6d& excess() const { return state_.excess; }
  [[nodiscard]] bool any() const { return (state_.excess.array() > 0.0).any(); }
  /// Covariance of what the parameters may be off by; `nominal` is that by the stated noise alone.
  [[nodiscard]] ParameterMatrix bend(const ParameterMatrix& nominal) const;

  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] State& state() { return state_; }

 private:
  State state_;
};

}  // namespace fathom::identification

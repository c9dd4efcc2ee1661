// How a fit treats bounds. A number that steps towards one only comes nearer, while the others step freely; the numbers
// that the linear picture wants on their bounds are put there and held.
#pragma once

#include <span>
#include <vector>

#include "common/identification/trajectories/fit_costs.hpp"

namespace fathom::identification {

struct BoundedStep {
  Eigen::VectorXd d;          ///< of the scaled numbers, inside their bounds
  Eigen::VectorXd deviation;  ///< of each number when all others are known
  double foretold{};          ///< fall of the cost that the linear picture promises for it
};

/// The step of all numbers from `x`, the initial velocities eliminated. `evaluations` must be up to date at x, with
/// derivatives.
[[nodiscard]] BoundedStep bounded_step(const Evaluations& evaluations, std::span<const WindowResidual> windows,
                                       const ParameterMap& map, const Eigen::VectorXd& x, int threads);

/// Places of the numbers that the step leaves on a bound and that were nearly there, by their scale or their deviation:
/// from afar the linear picture is too rough.
[[nodiscard]] std::vector<int> pressed_numbers(const ParameterMap& map, const Eigen::VectorXd& x,
                                               const BoundedStep& step);

/// The scaled numbers, `held` ones excepted. A step towards a bound at distance D goes D (1 - exp(-step / D)): to first
/// order the step, and never beyond.
class InsideBounds final : public ceres::Manifold {
 public:
  InsideBounds(const ParameterMap& map, const std::vector<int>& held);

  [[nodiscard]] int AmbientSize() const override { return static_cast<int>(low_.size()); }
  [[nodiscard]] int TangentSize() const override { return static_cast<int>(free_.size()); }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  std::vector<double> low_, high_;
  std::vector<std::size_t> free_;
};

}  // namespace fathom::identification

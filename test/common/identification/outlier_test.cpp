// Huber's loss per axis: the weight pulls as the loss does, and a fault of one axis leaves the others alone.
#include "common/identification/trajectories/outlier.hpp"

#include <doctest/doctest.h>

#include <array>

using namespace fathom::identification;

namespace {
constexpr std::array<AxisRows, 2> kAxes{{{0, 4}, {4, 6}}};
constexpr double kSlope = 1e-6;  // relative; central differences of a smooth function
}  // namespace

TEST_CASE("outlier: the cost is half the square until an axis is far out, and goes on along its slope") {
  Eigen::VectorXd residual = Eigen::VectorXd::Ones(10);
  CHECK(robust_cost(residual, kAxes) == doctest::Approx(5.0));
  const double bound = outlier_bound(4);
  residual.head(4) *= bound;  // norm 2 bound: twice the bound
  CHECK(robust_cost(residual, kAxes) == doctest::Approx(1.5 * bound * bound + 3.0));
}

TEST_CASE("outlier: least squares with the weight has the slope of the cost") {
  Eigen::VectorXd residual = Eigen::VectorXd::LinSpaced(10, -9.0, 4.0);
  const Eigen::VectorXd weight = robust_weight(residual, kAxes);
  CHECK(weight.head(4).maxCoeff() < 1.0);
  CHECK(weight.tail(6).minCoeff() == 1.0);
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    constexpr double kStep = 1e-5;
    Eigen::VectorXd up = residual, down = residual;
    up[i] += kStep;
    down[i] -= kStep;
    const double slope = (robust_cost(up, kAxes) - robust_cost(down, kAxes)) / (2.0 * kStep);
    CHECK(slope == doctest::Approx(weight[i] * weight[i] * residual[i]).epsilon(kSlope));
  }
}

// The analytic slope of the base force against central differences, over random motions.
#include "common/model/derivatives/state_matrix.hpp"

#include <doctest/doctest.h>

#include <random>

#include "test/support/virtual_dive.hpp"

using namespace fathom;

TEST_CASE("state matrix: the analytic slope agrees with central differences of the force") {
  constexpr double kStep = 1e-6;       // m/s, rad/s, rad
  constexpr double kAgreement = 1e-6;  // of the largest entry: rounding over the step; |nu| has no kink within it
  const model::Vehicle vehicle = test::vehicle_from_repository("beluga");
  model::Model model = model::nominal_model(vehicle, true);
  std::mt19937 random{5};
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < 50; ++draw) {
    for (double& number : model.theta) number = 10.0 * normal(random);
    model::Motion motion;
    motion.force = model::ActuatorForces::Zero(6);
    motion.vehicle = &vehicle;
    const Eigen::Vector3d turn{normal(random), normal(random), normal(random)};
    motion.R_WB = quaternion_from_rotation_vector(turn).toRotationMatrix();
    for (double& speed : motion.nu) speed = normal(random);
    const auto force = [&](Eigen::Index column, double step) {
      model::Motion moved = motion;
      if (column < 3) {
        moved.R_WB *= quaternion_from_rotation_vector(step * Eigen::Vector3d::Unit(column)).toRotationMatrix();
      } else {
        moved.nu[column - 3] += step;
      }
      model::Load load;
      return model::generalised_force(model, moved, load);
    };
    const auto slope = model::base_force_slope(model.theta, motion);
    for (Eigen::Index column = 0; column < 9; ++column) {
      const Vector6d expected = (force(column, kStep) - force(column, -kStep)) / (2.0 * kStep);
      CHECK((slope.col(column) - expected).norm() < kAgreement * slope.cwiseAbs().maxCoeff());
    }
  }
}

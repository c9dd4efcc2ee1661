// The force that a model lacks, and nothing else: what is left of the truth is what sampling leaves.
#include "common/residual/force_residual.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::residual;

TEST_CASE("force residual: that of the truth is noise, and finds a force the model lacks") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 60.0, .seed = 4, .velocity_noise = 0.0, .rate_noise = 0.0});
  model::Model light = dive.truth;
  light.theta[model::index(model::BaseParameter::W_B)] -= 3.0;
  const auto exact = wrench_residuals(dive.truth, dive.trial);
  const auto lacking = wrench_residuals(light, dive.trial);
  double worst = 0.0;
  for (std::size_t k = 20; k + 20 < exact.size(); ++k) {
    // 3 N of weight along the world's down: yaw alone is free, so almost all of it in heave.
    CHECK(lacking[k][2] - exact[k][2] == doctest::Approx(3.0 * dive.trial.q_WB[k].toRotationMatrix()(2, 2)));
    worst += exact[k].head<3>().squaredNorm() / static_cast<double>(exact.size());
  }
  CHECK(std::sqrt(worst) < 0.1);  // N, of 20 N applied: velocity is not quite straight between samples
}

// The base model's fit leaves a wrong valley: a vehicle without inertia, whose rates follow its thrust at once.
#include "common/identification/trajectories/fit_from_priors.hpp"

#include <doctest/doctest.h>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

double& number(model::Model& model, const char* name) {
  return model.theta[model::index(*model::parameter_from_name(name))];
}

}  // namespace

TEST_CASE("fit from priors: a vehicle without inertia is a valley of its own, and is left") {
  const model::Vehicle vehicle = test::vehicle_from_repository("beluga");
  for (const unsigned seed : {1U, 2U, 3U}) {
    test::VirtualDive dive = test::make_dive(vehicle, {.duration = 160.0, .seed = seed});
    const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {.window = 4.0, .threads = 2}};
    model::Model start = model::nominal_model(vehicle, false);
    number(start, "I_X") = 0.01;
    number(start, "K_p|p|") = 0.0;
    number(start, "K_p") = -100.0;
    FitResult stuck = problem.fit(start);
    CAPTURE(seed);
    REQUIRE(number(stuck.model, "I_X") < 0.01);  // no step leads out
    FitResult fit = with_plausible_masses(problem, stuck);
    CHECK(number(fit.model, "I_X") == doctest::Approx(number(dive.truth, "I_X")).epsilon(0.02));  // 4 sigma
    CHECK(fit.cost < stuck.cost);
  }
}

TEST_CASE("fit from priors: masses that are in proportion are left as they are, bit for bit") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 60.0, .seed = 4});
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {.window = 4.0, .threads = 2}};
  const FitResult fit = problem.fit(model::nominal_model(vehicle, false));
  CHECK(with_plausible_masses(problem, fit).model.theta == fit.model.theta);
}

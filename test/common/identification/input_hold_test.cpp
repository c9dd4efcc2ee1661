// How commands acted between their samples is found from the motion, and is not taken for a delay of the vehicle.
#include "common/identification/input_hold.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/identification/fit_from_priors.hpp"
#include "common/identification/sparse.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr double kTimes[] = {-0.5, 0.0, 0.5};  // of the time between inputs
constexpr double kFound = 0.08;                // of it: noise of two minutes, and the steps of the integration

test::VirtualDive dive_of(const model::Vehicle& vehicle, double hold, unsigned seed) {
  return test::make_dive(vehicle, {.duration = 120.0, .seed = seed, .input_hold = hold});
}

double error(const FitResult& fit, const model::Model& truth) {
  double square = 0.0;
  for (const NamedValue& value : fit.parameters()) {
    const double real = truth.theta[model::index(*model::parameter_from_name(value.name))];
    square += std::pow((value.value - real) / real, 2);
  }
  return std::sqrt(square);
}

}  // namespace

TEST_CASE("input hold: lines, held and told afterwards are told apart, and the numbers come out better for it") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  for (const double hold : kTimes) {
    const test::VirtualDive dive = dive_of(vehicle, hold, 5);
    const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {.window = 5.0, .threads = 2}};
    const FitResult plain = problem.fit(model::nominal_model(vehicle, false));
    const FitResult fit = with_input_hold(problem, fit_from_priors(vehicle, {&dive.trial, 1}, problem.settings()));
    CAPTURE(hold);
    CHECK(std::abs(fit.model.input_hold - hold) < kFound);
    if (hold != 0.0) CHECK(error(fit, dive.truth) < 0.7 * error(plain, dive.truth));
  }
}

TEST_CASE("input hold: found on a coarser grid too, where a step holds several commands") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  for (const double hold : kTimes) {
    const test::VirtualDive dive =
        test::make_dive(vehicle, {.duration = 60.0, .dt = 0.02, .seed = 5, .input_hold = hold});
    const Trial coarse = sparse(dive.trial, 0.04);
    REQUIRE(coarse.dt == doctest::Approx(0.04));
    const TrajectoryFit problem{vehicle, {&coarse, 1}, {.window = 5.0, .threads = 2}};
    const FitResult fit = with_input_hold(problem, fit_from_priors(vehicle, {&coarse, 1}, problem.settings()));
    CAPTURE(hold);
    CHECK(std::abs(fit.model.input_hold - hold) < 4.0 * kFound);  // this yaw settles within a step, which blurs it
  }
}

TEST_CASE("input hold: what a lag without a name had taken is given back once the lag has one") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  constexpr int kSecondOrder = 3;
  constexpr double kTimeConstant = 0.2;  // s
  const std::vector<model::ActiveEffect> lag{test::active("thruster_lag", {kTimeConstant, 0.0}, kSecondOrder)};
  const test::VirtualDive dive = test::make_dive(
      vehicle, {.duration = 60.0, .dt = 0.04, .seed = 6, .velocity_noise = 0.002, .rate_noise = 0.002, .effects = lag});
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {.window = 5.0, .threads = 2}};
  const FitResult base = with_input_hold(problem, problem.fit(model::nominal_model(vehicle, false)));
  CHECK(base.model.input_hold == 0.5);  // all that a hold can pass for
  model::Model model = base.model;
  model.add(lag.front());
  const FitResult fit = with_input_hold(problem, problem.fit(model, &base));
  CHECK(std::abs(fit.model.input_hold) < kFound);
  CHECK(std::abs(fit.model.effects.front().theta[0] - kTimeConstant) < 0.01 * kTimeConstant);
}

TEST_CASE("input hold: a delay of the vehicle is left to the effect that says so") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive = test::make_dive(
      vehicle, {.duration = 120.0, .seed = 6, .input_hold = 0.5, .effects = {test::active("thruster_delay", {0.2})}});
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {.window = 5.0, .threads = 2}};
  model::Model model = model::nominal_model(vehicle, false);
  CHECK(input_hold(problem, problem.fit(model)) == 0.5);  // the bound: what is later is not the log's doing
  model.add(test::active("thruster_delay", {0.1}));
  model.input_hold = 0.5;
  FitResult fit = problem.fit(model);
  CHECK(input_hold(problem, fit) == 0.5);
  problem.add_covariance(fit);
  const std::vector<NamedValue> numbers = fit.parameters();
  const NamedValue& delay = *std::ranges::find(numbers, "thruster_delay.delay", &NamedValue::name);
  CHECK(std::abs(delay.value - 0.2) < 2.0 * delay.std);
  CHECK(delay.std > 0.1 / std::sqrt(12.0));  // whatever the data: they could have been straight lines
}

// How uncertain numbers spread a prediction, against rollouts by hand, and what was not visited.
#include "common/learning/spread.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/learning/learn.hpp"
#include "common/learning/wording.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;

namespace {

/// A steady force along X whose weight is known to `sigma`, everything else exactly.
likelihood::Fit steady_force(const likelihood::Problem& problem, double sigma) {
  likelihood::Fit fit;
  fit.finite = true;
  fit.hypothesis = likelihood::nominal_hypothesis(problem);
  fit.hypothesis.force.features = {{.axis = 0, .count = 0, .scale = 1.0}};
  fit.hypothesis.force.groups = {{.kind = "a force", .axis = 0, .first = 0, .count = 1}};
  fit.hypothesis.force.weights = {2.0};
  fit.numbers = problem.numbers(fit.hypothesis);
  const auto p = static_cast<Eigen::Index>(fit.numbers.size());
  fit.information = 1e16 * Eigen::MatrixXd::Identity(p, p);
  for (Eigen::Index j = 0; j < p; ++j) {
    if (fit.numbers[static_cast<std::size_t>(j)].kind == likelihood::NumberKind::kWeight)
      fit.information(j, j) = 1.0 / (sigma * sigma);
  }
  return fit;
}

}  // namespace

TEST_CASE("spread: a weight's deviation moves the end of a prediction as a rollout with it does") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 30.0, .dt = 0.05});
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  constexpr double kSigma = 0.1;  // N
  const likelihood::Fit fit = steady_force(problem, kSigma);
  model::Visited visited;
  visited.nu.setConstant(10.0);
  const model::Window window{&dive.trial, 100, 200};
  const auto end = [&](double weight) {
    model::FreeForce force = fit.hypothesis.force;
    force.weights = {weight};
    const model::LearnedForce learned{force, visited, fit.hypothesis.model.allocation};
    const model::Model model = learning::as_model(fit.hypothesis, 0.05, &learned);
    model::VelocityTrace nu;
    REQUIRE(model::rollout(model, window, dive.trial.nu[100], nu));
    return Vector6d{nu.col(nu.cols() - 1)};
  };
  const Vector6d by_hand = (end(2.0 + kSigma) - end(2.0)).cwiseAbs();
  REQUIRE(by_hand[0] > 1e-4);
  const Vector6d sigma =
      learning::spread_of(fit, visited, [](const model::FreeForce& all) { return all; }, 0.05, {&window, 1});
  for (Eigen::Index i = 0; i < 6; ++i) {
    CAPTURE(i);
    CHECK(sigma[i] == doctest::Approx(by_hand[i]).epsilon(1e-3));
  }
  // What is not told spreads nothing.
  const Vector6d untold =
      learning::spread_of(fit, visited, [](const model::FreeForce&) { return model::FreeForce{}; }, 0.05, {&window, 1});
  CHECK(untold.maxCoeff() < 1e-6);
}

TEST_CASE("spread: motion beyond what was visited is counted and said") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  auto dive = test::fly(vehicle, {.duration = 10.0, .dt = 0.1});
  for (std::size_t k = 0; k < dive.trial.size(); ++k) dive.trial.nu[k][0] = 4 * k < dive.trial.size() ? 1.0 : 0.1;
  model::FreeForce force;
  force.features = {{.axis = 0, .count = 1, .factors = {{{.quantity = model::Quantity::kVelocity, .index = 0}}}}};
  force.groups = {{.kind = "velocity", .axis = 0, .count = 1}};
  force.weights = {1.0};
  model::Visited visited;
  visited.nu.setConstant(0.5);
  const model::LearnedForce learned{force, visited, vehicle.allocation};
  const double share = learning::not_visited(dive.truth, learned, {&dive.trial, 1});
  CHECK(share == doctest::Approx(0.25).epsilon(0.05));
  // Carried along by the water, the craft is as fast past it as ever.
  model::Model carried = dive.truth;
  std::vector<double> theta(model::find_effect("current")->parameters().size(), 0.0);
  theta[0] = 3.0;
  carried.add({.effect = model::find_effect("current"), .theta = theta});
  CHECK(learning::not_visited(carried, learned, {&dive.trial, 1}) > 0.5);
  CorrectionGiven given;
  given.prediction_std = {0.012, 0.0, 0.0, 0.0, 0.0, 0.003};
  given.not_visited = 0.25;
  CHECK(learning::spread_sentence(given) ==
        " On what judges, all numbers together leave predictions of 10 s open by u 0.012 m/s, r 0.003 rad/s (standard "
        "deviation). Of it 25.0 % lies where the force was not learned, not visited: there it fades.");
  CHECK(learning::spread_sentence({}).empty());
}

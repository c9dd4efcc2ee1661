// Deviations as reported, correlations of the information, by hand.
#include "common/verdict/covariance.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;

TEST_CASE("covariance: a delay is no better known than the clock of the commands that it is told after") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 30.0});
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  likelihood::Fit fit;
  fit.hypothesis = likelihood::nominal_hypothesis(problem);
  fit.hypothesis.model.effects.push_back(test::active("thruster_delay", {0.1}));
  fit.numbers = problem.numbers(fit.hypothesis);
  const auto p = static_cast<Eigen::Index>(fit.numbers.size());
  const Eigen::VectorXd sigma = verdict::after_the_commands_clock(problem, fit, Eigen::VectorXd::Constant(p, 1e-4));
  int widened = 0;
  for (Eigen::Index j = 0; j < p; ++j) {
    const bool delay = fit.numbers[static_cast<std::size_t>(j)].name == "thruster_delay.delay";
    widened += delay ? 1 : 0;
    if (delay) CHECK(sigma[j] > problem.number_settings.offset_sigma);
    if (!delay) CHECK(sigma[j] == 1e-4);
  }
  CHECK(widened == 1);
}

TEST_CASE("covariance: deviations are those that are reported, correlations those of the information") {
  likelihood::Fit fit;
  fit.finite = true;
  fit.numbers = {{.kind = likelihood::NumberKind::kBase, .name = "m_X"},
                 {.kind = likelihood::NumberKind::kWeight, .name = "w"},
                 {.kind = likelihood::NumberKind::kEffect, .name = "current.north"}};
  // Inverse of [[2, 0, 1], [0, 1, 0], [1, 0, 1]]: 1, -1; -1, 2: correlation -1 / sqrt(2).
  fit.information = Eigen::Matrix3d{{2.0, 0.0, 1.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 1.0}};
  VerdictGiven given;
  verdict::put_covariance(fit, Eigen::Vector3d{3.0, 1.0, 0.5}, given);
  CHECK(given.covariance_of == std::vector<std::string>{"m_X", "current.north"});
  REQUIRE(given.covariance.size() == 4);
  CHECK(given.covariance[0] == doctest::Approx(9.0));
  CHECK(given.covariance[1] == doctest::Approx(-1.5 / std::sqrt(2.0)));
  CHECK(given.covariance[2] == doctest::Approx(given.covariance[1]));
  CHECK(given.covariance[3] == doctest::Approx(0.25));

  VerdictGiven none;
  fit.finite = false;
  verdict::put_covariance(fit, Eigen::Vector3d::Ones(), none);
  CHECK(none.covariance_of.empty());
}

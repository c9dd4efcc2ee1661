#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/likelihood/fit.hpp"
#include "common/likelihood/response.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::likelihood;

TEST_CASE("evidence: Laplace's method is the integral, where one number is free") {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 30.0, .force = 0.05});
  vehicle.parameters = {"X_u"};
  vehicle.priors = {{.mean = dive.truth.theta[model::index(model::BaseParameter::X_u)] - 1.0, .sigma = 2.0}};
  Problem problem = make_problem(vehicle, {&dive.trial, 1});
  problem.number_settings.command_offset = false;
  Hypothesis hypothesis = nominal_hypothesis(problem);
  hypothesis.model.theta = dive.truth.theta;
  const Noise noise = prior_noise(problem);
  const Fit found =
      fit(problem, hypothesis, noise, {.noise_rounds = 1, .steps = 10, .enough = 1e-4, .fit_noise = false});
  REQUIRE(found.numbers.size() == 1);
  const double best = value(found.hypothesis, found.numbers[0]), sigma = found.sigma()[0];
  double integral = 0.0;
  const double step = 0.25 * sigma;
  for (int k = -24; k <= 24; ++k) {
    Hypothesis there = found.hypothesis;
    at(there, found.numbers[0]) = best + k * step;
    const double log_likelihood = pass(problem, there, found.numbers, noise, {.derivatives = false}).log_likelihood;
    integral +=
        step * std::exp(log_likelihood + log_prior(found.numbers, values(there, found.numbers)) - found.log_likelihood);
  }
  const double laplaces =
      laplace(found.numbers, values(found.hypothesis, found.numbers), found.log_likelihood, found.information);
  // The gain held fixed in the derivative, and what is not Gaussian about the posterior.
  CHECK(laplaces == doctest::Approx(found.log_likelihood + std::log(integral)).epsilon(0.1 / std::abs(laplaces)));
}

TEST_CASE("priors: both densities are whole, and their weights are their slopes") {
  for (const double freedom : {0.0, kEffectFreedom}) {
    const Number number{.mean = 2.0, .sigma = 0.5, .freedom = freedom};
    double whole = 0.0;
    constexpr double kStep = 1e-3;
    for (double x = -60.0; x < 64.0; x += kStep) whole += kStep * std::exp(log_prior(number, x));
    CHECK(whole == doctest::Approx(1.0).epsilon(1e-3));
    for (const double x : {2.0, 2.3, 0.0, 12.0}) {
      const double slope = (log_prior(number, x + 1e-4) - log_prior(number, x - 1e-4)) / 2e-4;
      CHECK(slope == doctest::Approx(-(x - number.mean) * prior_weight(number, x)).epsilon(1e-5).scale(1.0));
    }
  }
}

TEST_CASE("fit: a number that is far larger than ordinary is found all the same") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  // Third-order drag that is ordinary at a metre per second, forty times over: at these speeds it is a few newtons.
  constexpr double kTrue = 2000.0;
  test::NoisyDive settings{.duration = 40.0, .force = 0.01, .effects = {test::active("cubic_drag", {kTrue}, 1)}};
  const auto dive = test::fly(vehicle, settings);
  const Problem problem = make_problem(vehicle, {&dive.trial, 1});
  Hypothesis start = nominal_hypothesis(problem);
  start.model.add(test::active("cubic_drag", {50.0}, 1));
  const Fit found = fit(problem, start, prior_noise(problem), {.noise_rounds = 4});
  const auto number = std::ranges::find(found.numbers, NumberKind::kEffect, &Number::kind);
  REQUIRE(number != found.numbers.end());
  const double sigma = found.sigma()[number - found.numbers.begin()];
  CHECK(std::abs(value(found.hypothesis, *number) - kTrue) < 3.0 * sigma);
  CHECK(sigma < 0.2 * kTrue);
}

TEST_CASE("fit: a number on its limit comes back where all together want it inside") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 40.0, .force = 0.01});
  const Problem problem = make_problem(vehicle, {&dive.trial, 1});
  const FitOptions options{.noise_rounds = 1, .steps = 8, .fit_noise = false};
  const Fit plain = fit(problem, nominal_hypothesis(problem), prior_noise(problem), options);
  // All linear drag in the quadratic one's place: its own slope alone pushes it outwards.
  Hypothesis start = plain.hypothesis;
  start.model.theta[model::index(model::BaseParameter::X_u)] = 0.0;
  start.model.theta[model::index(model::BaseParameter::X_uu)] *= 3.0;
  const Fit back = fit(problem, start, prior_noise(problem), options);
  CHECK(back.log_posterior == doctest::Approx(plain.log_posterior).epsilon(0.2 / std::abs(plain.log_posterior)));
}

TEST_CASE("response: the score of a column is its inner product with the adjoint") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 20.0, .force = 0.05});
  const Problem problem = make_problem(vehicle, {&dive.trial, 1});
  Fit base{.hypothesis = nominal_hypothesis(problem), .noise = prior_noise(problem)};
  base.numbers = problem.numbers(base.hypothesis);
  Reference reference;
  refer(problem, base, reference, 1);
  const Eigen::MatrixXd slope = adjoint(problem, reference[0], 0);
  const auto column = [](std::size_t block, int axis) { return std::sin(0.1 * static_cast<double>(block) + axis); };
  ResponseSums sums;
  respond(
      problem, reference[0], 0, 1, {},
      [&](std::size_t block, ColumnsOut acceleration, ColumnsOut) {
        for (int i = 0; i < acceleration.rows(); ++i)
          acceleration(i, 0) = i < problem.simulated ? column(block, i) : 0.0;
      },
      sums);
  double product = 0.0;
  for (Eigen::Index b = 0; b < slope.cols(); ++b) {
    for (int i = 0; i < problem.simulated; ++i) product += slope(i, b) * column(static_cast<std::size_t>(b), i);
  }
  CHECK(sums.gradient[0] == doctest::Approx(product).epsilon(1e-9));
  // Columns that are no whole lanes, told as one product.
  const Eigen::RowVectorXd share = Eigen::RowVectorXd::LinSpaced(5, 1.0, 3.0);
  ResponseSums shares;
  respond(
      problem, reference[0], 0, 5, {},
      [&](std::size_t block, ColumnsOut acceleration, ColumnsOut) {
        Eigen::VectorXd force = Eigen::VectorXd::Zero(acceleration.rows());
        for (int i = 0; i < problem.simulated; ++i) force[i] = column(block, i);
        acceleration = force * share;
      },
      shares);
  for (Eigen::Index j = 0; j < 5; ++j) CHECK(shares.gradient[j] == doctest::Approx(share[j] * product).epsilon(1e-9));
}

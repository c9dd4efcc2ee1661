// Increment fits on problems whose answer is known: matrix, constants, delay, and what they do with bad windows.
#include "common/consistency/increments/increments.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/base/statistics.hpp"

namespace fathom::consistency {
namespace {

constexpr double kStep = 0.1;  // s
constexpr int kSamples = 3000;
constexpr int kCount = 9;  // samples per window

Eigen::Vector3d signal(double t) {
  return {std::sin(0.9 * t) + 0.4 * std::sin(2.3 * t), std::cos(0.7 * t) + 0.3 * std::sin(2.9 * t),
          std::sin(1.3 * t + 1.0)};
}

struct Case {
  Eigen::Matrix3d M{Eigen::Matrix3d::Identity()};
  Eigen::Vector3d constant{Eigen::Vector3d::Zero()};
  double delay{}, noise{};
};

/// y = integral of M x + constant over 0.8 s; the sensor logs x late.
IncrementProblem problem_of(const Case& c, std::mt19937& random) {
  std::normal_distribution<double> normal{0.0, c.noise > 0.0 ? c.noise : 1.0};
  IncrementProblem problem;
  problem.step = kStep;
  problem.fixed_columns = 3;
  for (int i = 0; i < kSamples; ++i) problem.t.push_back(i * kStep);
  const std::vector<double> weight = quadrature_weights(problem.t.data(), kCount);
  double length = 0.0;
  for (const double w : weight) length += w;
  for (int first = 0; first + kCount <= kSamples; first += 4) {
    IncrementProblem::Window window{first, kCount, static_cast<int>(problem.basis.size())};
    Eigen::Vector3d y = c.constant * length;
    for (int s = 0; s < kCount; ++s) {
      const double w = weight[static_cast<std::size_t>(s)];
      problem.basis.emplace_back(w * Eigen::Matrix3d::Identity());
      y += w * (c.M * signal((first + s) * kStep));
    }
    if (c.noise > 0.0) y += Eigen::Vector3d(normal(random), normal(random), normal(random));
    problem.windows.push_back(window);
    problem.y.push_back(y);
    problem.fixed.emplace_back(length * Eigen::Matrix3d::Identity());
  }
  return problem;
}

Series sensor_of(const Case& c) {
  Series sensor;
  for (double t = -2.0; t < kSamples * kStep + 2.0; t += 0.5 * kStep) {
    sensor.t.push_back(t);
    sensor.x.push_back(signal(t - c.delay));
  }
  return sensor;
}

}  // namespace

TEST_CASE("increments: quadrature weights are exact for cubics and sum to the window") {
  std::vector<double> t;
  t.reserve(kCount);
  for (int i = 0; i < kCount; ++i) t.push_back(2.0 + 0.1 * i);
  const std::vector<double> weight = quadrature_weights(t.data(), kCount);
  for (int power = 0; power <= 3; ++power) {
    double sum = 0.0;
    for (std::size_t i = 0; i < t.size(); ++i) sum += weight[i] * std::pow(t[i], power);
    const double exact = (std::pow(t.back(), power + 1) - std::pow(t.front(), power + 1)) / (power + 1);
    CHECK(sum == doctest::Approx(exact).epsilon(1e-12));
  }
}

TEST_CASE("increments: matrix, constants and delay come back, with errors that cover them") {
  Case c{.constant = {0.02, -0.03, 0.01}, .delay = 0.237, .noise = 0.01};
  c.M << 0.1, -1.02, 0.0, 0.97, 0.05, 0.02, -0.03, 0.0, 1.1;
  std::mt19937 random{4};
  const IncrementFit fit = fit_increments(problem_of(c, random), sensor_of(c), {});
  REQUIRE(fit.ok);
  CHECK(fit.delay_found);
  constexpr double kSigmas = 5.0;
  constexpr double kLargestSigma = 0.01;  // s, or of M and constants
  const double delay_sigma = jackknife_sigma(fit.delay_replicates);
  CHECK(delay_sigma < kLargestSigma);
  CHECK(std::abs(fit.delay - c.delay) < kSigmas * delay_sigma + 1e-4);
  REQUIRE(fit.theta.size() == 12);
  for (int i = 0; i < 12; ++i) {
    std::vector<double> replicates;
    for (const Eigen::VectorXd& theta : fit.theta_replicates) replicates.push_back(theta[i]);
    const double truth = i < 9 ? c.M(i % 3, i / 3) : c.constant[i - 9];
    const double sigma = jackknife_sigma(replicates);
    CAPTURE(i);
    CHECK(sigma < kLargestSigma);
    CHECK(std::abs(fit.theta[i] - truth) < kSigmas * sigma + 1e-4);
  }
  CHECK(fit.explained > 0.99);
  CHECK(fit.residual.maxCoeff() == doctest::Approx(c.noise).epsilon(0.2));
  CHECK(fit.outlier_times.empty());
}

TEST_CASE("increments: windows that miss by far are named and bend nothing") {
  Case c{.noise = 0.005};
  std::mt19937 random{5};
  IncrementProblem problem = problem_of(c, random);
  for (const std::size_t w : {100U, 101U, 400U}) problem.y[w] += Eigen::Vector3d(3.0, -3.0, 0.0);
  const IncrementFit fit = fit_increments(problem, sensor_of(c), {});
  REQUIRE(fit.ok);
  REQUIRE(fit.outlier_times.size() == 3);
  CHECK(fit.outlier_times[2] == doctest::Approx(problem.t[400 * 4 + kCount / 2]));
  CHECK((Eigen::Map<const Eigen::Matrix3d>(fit.theta.data()) - c.M).cwiseAbs().maxCoeff() < 0.005);
  // What is large for the noise but too small to matter is no outlier.
  CHECK(fit_increments(problem, sensor_of(c), {.outlier_floor = 10.0}).outlier_times.empty());
}

TEST_CASE("increments: no delay is claimed beyond the search, without motion, or when none was asked for") {
  std::mt19937 random{6};
  const Case late{.delay = 1.6, .noise = 0.01};
  CHECK_FALSE(fit_increments(problem_of(late, random), sensor_of(late), {.longest_delay = 1.1}).delay_found);
  const Case still{.M = Eigen::Matrix3d::Zero(), .noise = 0.01};  // the sensor explains nothing
  CHECK_FALSE(fit_increments(problem_of(still, random), sensor_of(still), {}).delay_found);
  const Case plain{.delay = 0.2, .noise = 0.01};
  const IncrementFit fixed = fit_increments(problem_of(plain, random), sensor_of(plain), {.search_delay = false});
  CHECK(fixed.ok);
  CHECK(fixed.delay == 0.0);
  CHECK_FALSE(fixed.delay_found);
}

TEST_CASE("increments: too little common data is said, not fitted") {
  std::mt19937 random{7};
  const Case c;
  const IncrementProblem problem = problem_of(c, random);
  Series elsewhere = sensor_of(c);
  for (double& t : elsewhere.t) t += 1e4;
  CHECK_FALSE(fit_increments(problem, elsewhere, {}).ok);
  CHECK(fit_increments(problem, elsewhere, {}).why_not == "too little common data");
  CHECK_FALSE(fit_increments(problem, Series{}, {}).ok);
  CHECK_FALSE(fit_increments(IncrementProblem{}, sensor_of(c), {}).ok);
}

}  // namespace fathom::consistency

#include "common/likelihood/filter.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/likelihood/fit.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::likelihood;

namespace {

Hypothesis with(const Problem& problem, const model::ActiveEffect& effect) {
  Hypothesis hypothesis = nominal_hypothesis(problem);
  hypothesis.model.add(effect);
  return hypothesis;
}

Fit fitted(const Problem& problem, const Hypothesis& hypothesis) {
  return fit(problem, hypothesis, prior_noise(problem),
             {.noise_rounds = 20, .steps = 6, .enough = 0.005, .round_enough = 0.02});
}

}  // namespace

TEST_CASE("filter: its sensitivities are those of its innovations") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive =
      test::fly(vehicle, {.duration = 30.0,
                          .force = 0.05,
                          .effects = {test::active("current", {0.1, -0.05}), test::active("thruster_lag", {0.1, 0.0}),
                                      test::active("fluid_memory", {5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.8, 0.0}, 0)}});
  const Problem problem = make_problem(vehicle, {&dive.trial, 1});
  Hypothesis hypothesis = nominal_hypothesis(problem);
  hypothesis.model = dive.truth;  // at the truth what the gain's own derivative adds has no mean
  const auto numbers = problem.numbers(hypothesis);
  const Noise noise = prior_noise(problem);
  Reference reference;
  const PassResult here = pass(problem, hypothesis, numbers, noise, {}, &reference);
  REQUIRE(here.finite);
  for (std::size_t j = 0; j < numbers.size(); ++j) {
    CAPTURE(numbers[j].name);
    const double step = 30.0 * numbers[j].step;
    const auto moved = [&](double by) {
      Hypothesis other = hypothesis;
      at(other, numbers[j]) += by;
      Reference there;
      REQUIRE(pass(problem, other, numbers, noise, {}, &there).finite);
      return there[0].innovation;
    };
    const Eigen::MatrixXd numeric = (moved(step) - moved(-step)) / (2.0 * step);
    double off = 0.0, size = 0.0;
    const int n = reference[0].axes;
    for (Eigen::Index b = 0; b < numeric.cols(); ++b) {
      for (int i = 0; i < n; ++i) {
        const double J = reference[0].J(n * b + i, static_cast<Eigen::Index>(j));
        off += (J - numeric(i, b)) * (J - numeric(i, b));
        size += numeric(i, b) * numeric(i, b);
      }
    }
    // The gain is held, columns are taken in a block's middle, and thrust edges inside blocks are not theirs.
    if (size < 4.0) continue;  // two standard deviations in all: nothing that a fit could see
    CHECK(std::sqrt(off) < 0.08 * std::sqrt(size));
  }
}

TEST_CASE("filter: base numbers come out within their deviations, and innovations are white") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  double square = 0.0, count = 0.0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const auto dive = test::fly(vehicle, {.duration = 120.0, .seed = seed, .force = 0.05});
    const Problem problem = make_problem(vehicle, {&dive.trial, 1});
    const Fit found = fitted(problem, nominal_hypothesis(problem));
    REQUIRE(found.finite);
    const Eigen::VectorXd sigma = found.sigma();
    for (std::size_t j = 0; j < found.numbers.size(); ++j) {
      const Number& number = found.numbers[j];
      if (number.kind != NumberKind::kBase) continue;
      const double pull =
          (value(found.hypothesis, number) - dive.truth.theta[number.index]) / sigma[static_cast<Eigen::Index>(j)];
      CAPTURE(number.name);
      CHECK(std::abs(pull) < 4.5);
      square += pull * pull;
      count += 1.0;
    }
    Reference reference;
    Fit again = found;
    refer(problem, again, reference, 1);
    const auto& e = reference[0].innovation;
    for (Eigen::Index i = 0; i < problem.simulated; ++i) {
      const Eigen::Index n = e.cols() - 60;
      const Eigen::VectorXd x = e.row(i).tail(n);
      const double variance = x.squaredNorm() / static_cast<double>(n);
      const double neighbours = x.head(n - 1).dot(x.tail(n - 1)) / x.squaredNorm();
      CAPTURE(i);
      CHECK(variance == doctest::Approx(1.0).epsilon(0.15));
      CHECK(std::abs(neighbours) < 3.5 / std::sqrt(static_cast<double>(n)));
    }
  }
  CHECK(std::sqrt(square / count) < 1.5);
}

TEST_CASE("filter: the odds of an effect do not depend on the rate of the data") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(
      vehicle, {.duration = 60.0, .dt = 0.01, .force = 0.05, .effects = {test::active("current", {0.02, 0.0})}});
  std::vector<double> odds;
  for (const double rate : {25.0, 50.0, 100.0}) {
    const Problem problem = make_problem(vehicle, {&dive.trial, 1}, {.block_rate = rate});
    const Fit base = fitted(problem, nominal_hypothesis(problem));
    const Fit current = fitted(problem, with(problem, test::active("current", {0.01, 0.0})));
    odds.push_back(current.log_evidence - base.log_evidence);
  }
  CAPTURE(odds[0]);
  CAPTURE(odds[1]);
  CAPTURE(odds[2]);
  CHECK(odds[0] > 10.0);
  CHECK(std::abs(odds[1] - odds[0]) < 1.0);
  CHECK(std::abs(odds[2] - odds[0]) < 1.0);
}

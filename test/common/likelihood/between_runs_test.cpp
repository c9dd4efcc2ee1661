#include "common/likelihood/between_runs.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::likelihood;

namespace {

constexpr int kRuns = 4;

/// Four runs of a vehicle whose surge drag is another in each by `spread` N s/m, fitted together.
struct Runs {
  explicit Runs(double spread) {
    vehicle = test::vehicle_from_repository("bluerov2");
    std::vector<test::VirtualDive> dives;
    for (int r = 0; r < kRuns; ++r) {
      // Drag that differs is an acceleration beside the model's own.
      const double off = spread * (r % 2 == 0 ? 1.0 : -1.0);
      dives.push_back(test::fly(vehicle, {.duration = 40.0,
                                          .seed = static_cast<unsigned>(r + 1),
                                          .force = 0.02,
                                          .outside = [off](double, const Vector6d& nu) {
                                            return Vector6d{off * nu[0], 0.0, 0.0, 0.0, 0.0, 0.0};
                                          }}));
    }
    for (test::VirtualDive& dive : dives) trials.push_back(std::move(dive.trial));
    problem = make_problem(vehicle, trials);
    Fit shared = fit(problem, nominal_hypothesis(problem), prior_noise(problem), {.noise_rounds = 2, .steps = 3});
    REQUIRE(shared.finite);
    between = between_runs(problem, shared, 2);
    narrow = shared.sigma();
    for (std::size_t j = 0; j < shared.numbers.size(); ++j) {
      if (shared.numbers[j].name == "X_u") surge = static_cast<Eigen::Index>(j);
      if (shared.numbers[j].name == "m_Y") sway = static_cast<Eigen::Index>(j);
    }
    REQUIRE(surge >= 0);
    REQUIRE(sway >= 0);
  }
  model::Vehicle vehicle;
  std::vector<Trial> trials;
  Problem problem;
  BetweenRuns between;
  Eigen::VectorXd narrow;
  Eigen::Index surge{-1}, sway{-1};
};

}  // namespace

TEST_CASE("between runs: a number that differs from run to run has the wider interval, and no other") {
  const Runs differ{0.15}, same{0.0};
  MESSAGE("X_u " << differ.narrow[differ.surge] << " -> " << differ.between.sigma[differ.surge] << ", spread "
                 << differ.between.spread[differ.surge] << " against " << same.between.spread[same.surge]);
  CHECK(differ.between.sigma[differ.surge] > 3.0 * differ.narrow[differ.surge]);
  CHECK(differ.between.spread[differ.surge] > 4.0 * same.between.spread[same.surge]);
  CHECK(same.between.sigma[same.surge] < 3.0 * same.narrow[same.surge]);
  for (Eigen::Index j = 0; j < same.narrow.size(); ++j) CHECK(same.between.sigma[j] >= same.narrow[j]);
}

TEST_CASE("between runs: one run tells nothing of others") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 20.0, .force = 0.05});
  const Problem problem = make_problem(vehicle, {&dive.trial, 1});
  Fit one{.hypothesis = nominal_hypothesis(problem), .noise = prior_noise(problem)};
  one.numbers = problem.numbers(one.hypothesis);
  Reference reference;
  refer(problem, one, reference, 1);
  const BetweenRuns between = between_runs(problem, one, 1);
  CHECK(between.spread.isZero(0.0));
  CHECK(between.sigma == one.sigma());
}

// The odds between explanations that look the same, and what each falsifies unnoticed.
#include "common/diagnosis/rivals.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "common/diagnosis/evidence.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

std::vector<double> costs(double each, double spread, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  std::vector<double> window(30);
  for (double& cost : window) cost = each + spread * normal(random);
  return window;
}

}  // namespace

TEST_CASE(
    "rivals: the odds between two explanations are their likelihoods' and what their numbers cost, from even on") {
  const std::vector<double> one = costs(50.0, 2.0, 1), better = costs(45.0, 2.0, 2);
  CHECK(log_odds_over(one, 2, one, 2) == 0.0);
  CHECK(log_odds_over(one, 3, one, 2) == 0.0);
  CHECK(log_odds_over(one, 2, one, 3) == 0.0);  // chosen all the same: even odds at least
  CHECK(log_odds_over(one, 2, better, 2) == doctest::Approx(robust_log_likelihood_ratio(one, better)));
  CHECK(log_odds_over(better, 2, one, 2) == 0.0);
  CHECK(log_odds_over(one, 2, better, 3) < log_odds_over(one, 2, better, 2));
}

TEST_CASE("rivals: a name is no surer than what it may be instead lets it be") {
  CHECK(log_odds_among(12.0, {}) == 12.0);
  const std::vector<Alternative> even{{"current", 0.0}}, two{{"current", 0.0}, {"wave", 0.0}}, unlikely{{"wave", 3.0}};
  CHECK(log_odds_among(50.0, even) == doctest::Approx(0.0));
  CHECK(log_odds_among(50.0, two) == doctest::Approx(-std::log(2.0)));
  CHECK(log_odds_among(50.0, unlikely) == doctest::Approx(3.0));
  CHECK(log_odds_among(1.0, unlikely) < 1.0);
}

TEST_CASE("rivals: what a weak vertical thruster falsifies is heave's numbers, by what it lacks") {
  std::mt19937 random{20261124};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const double gain = std::uniform_real_distribution<double>{-0.3, -0.1}(random);
    CAPTURE(gain);
    const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
    int vertical = -1;
    for (std::size_t i = 0; i < vehicle.thrusters.size(); ++i) {
      if (std::abs(vehicle.thrusters[i].axis_B.z()) > 0.9) vertical = static_cast<int>(i);
    }
    REQUIRE(vertical >= 0);
    const test::VirtualDive dive =
        test::make_dive(vehicle, {.seed = seed, .effects = {test::active("thruster_gain", {gain}, vertical)}});
    const identification::TrajectoryFit problem{vehicle, {&dive.trial, 1}, {}};
    const BaseNumbers numbers{problem, problem.fit(model::nominal_model(vehicle, false))};
    const Corruption moved = numbers.most_moved(numbers.fit().model, dive.truth);
    CAPTURE(moved.parameter);
    CHECK((moved.parameter == "m_Z" || moved.parameter.starts_with("Z_w") || moved.parameter == "W-B"));
    // Forces that are a share g too small look like masses and drag that are 1/(1 + g) too large.
    CHECK(moved.share == doctest::Approx(1.0 / (1.0 + gain) - 1.0).epsilon(0.3));
  }
}

TEST_CASE("rivals: of two times after a command that are shorter than a step neither cost rules the other out") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  constexpr double kStep = 0.04;  // s
  std::mt19937 random{1322};
  for (const auto& [low, high, beside] : {std::tuple{0.018, 0.026, true}, std::tuple{0.15, 0.2, false}}) {
    const double time = std::uniform_real_distribution<double>{low, high}(random);  // s
    CAPTURE(time);
    const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 80.0,
                                                             .dt = kStep,
                                                             .step = 0.004,
                                                             .seed = 61,
                                                             .effects = {test::active("thruster_delay", {time})}});
    const identification::TrajectoryFit problem{vehicle, {&dive.trial, 1}, {.window = 5.0}};
    const identification::FitResult without = problem.fit(model::nominal_model(vehicle, false));
    const auto with = [&](const char* name) {
      model::Model model = without.model;
      model.add(test::active(name, {time}));
      return problem.fit(model, &without);
    };
    const identification::FitResult delay = with("thruster_delay");
    identification::FitResult lag = with("thruster_lag");
    for (double& cost : lag.window_cost) cost += 5.0;  // far beyond what settles which it is
    REQUIRE(robust_log_likelihood_ratio(lag.window_cost, delay.window_cost) > kAlternativeLogOdds);
    Answers answers;
    answers.near.push_back({.effect = model::find_effect("thruster_lag")});
    Judged winner{.effect = model::find_effect("thruster_delay")};
    find_rivals(winner, delay, {{0, lag}}, answers, BaseNumbers{problem, without}, problem, {});
    REQUIRE(winner.aliased_with == std::vector<std::string>{"thruster_lag"});
    REQUIRE(winner.alternatives.size() == (beside ? 1 : 0));
    if (beside) CHECK(winner.alternatives[0].log_odds == 0.0);
  }
}

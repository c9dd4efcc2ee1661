// A measured column as a modulator of the learned library: a drag that goes with it is learned as such.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/learning/seek_force.hpp"
#include "common/learning/terms.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;

namespace {

double salinity(double t) { return 5.0 + 2.0 * std::sin(0.21 * t) + 1.5 * std::sin(0.57 * t + 1.0); }

const model::Vehicle& vehicle() {
  static const model::Vehicle kVehicle = [] {
    model::Vehicle one = test::vehicle_from_repository("bluerov2");
    model::add_candidate("salinity", one.candidates);
    return one;
  }();
  return kVehicle;
}

Trial salty_dive(double drag) {
  auto dive = test::fly(vehicle(),
                        {.duration = 60.0, .seed = 7, .force = 0.02, .outside = [&](double t, const Vector6d& nu) {
                           return Vector6d{-drag * (salinity(t) - 5.0) * std::abs(nu[0]) * nu[0] * Vector6d::Unit(0)};
                         }});
  for (const double t : dive.trial.t)
    dive.trial.columns.emplace_back(Eigen::Vector2d{salinity(t + 0.5 * dive.trial.dt), 0.0});
  dive.trial.column_units = {"psu"};
  return std::move(dive.trial);
}

}  // namespace

TEST_CASE("columns: drag that goes with a measured column is learned as drag by that column") {
  const Trial trial = salty_dive(0.4);
  const likelihood::Problem problem = likelihood::make_problem(vehicle(), {&trial, 1});
  const model::Scene scene = model::scene_of(vehicle(), {&trial, 1});
  const auto modulators = learning::modulators_of(problem, scene);
  const auto found = std::ranges::find(modulators, ", by salinity", &learning::Modulator::words);
  REQUIRE(found != modulators.end());
  REQUIRE(found->columns.size() == 1);
  const model::Factor& factor = found->columns.front().front();
  CHECK(factor.a == doctest::Approx(5.0).epsilon(0.1));
  CHECK(factor.b == doctest::Approx(std::sqrt(2.0 + 1.125)).epsilon(0.15));

  const likelihood::Fit base = likelihood::fit(problem, likelihood::nominal_hypothesis(problem),
                                               likelihood::prior_noise(problem), {.noise_rounds = 3});
  const inference::FreeForceFound learned = learning::seek_force(problem, base, scene, {}, 1, {}).all;
  REQUIRE(learned.fit.finite);
  REQUIRE_FALSE(learned.groups.empty());
  CHECK(learned.log_odds > learning::Limits{}.odds);
  CHECK(learned.groups.front().kind == "drag, by salinity");
  CHECK(learned.groups.front().axis == 0);
}

TEST_CASE("columns: a factor is the column about its mean, over its spread; 0 where nobody measures it") {
  model::Feature feature{.axis = 0, .count = 1, .scale = 2.0};
  feature.factors[0] = {
      .quantity = model::Quantity::kColumn, .index = 1, .a = 5.0, .b = 2.0, .c = 3.0, .column = "salinity"};
  const std::vector columns{0.0, 0.0, 8.0, 0.0};
  model::FeatureState state;
  CHECK(feature.value(state) == 0.0);
  state.columns = columns;
  CHECK(feature.value(state) == doctest::Approx(3.0));
  CHECK(feature.words() == "(salinity - 5) / 2");
}

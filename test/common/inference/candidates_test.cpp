// A hidden force that follows a measured column is named with its number; a column that nothing follows is not.
#include <doctest/doctest.h>

#include <cmath>

#include "common/inference/infer.hpp"
#include "common/model/candidates/column_effect.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::inference;

namespace {

/// m/s, gusts of some seconds about a breeze.
double wind(double t) { return 5.0 + 2.0 * std::sin(0.21 * t) + 1.5 * std::sin(0.57 * t + 1.0); }

struct Asked {
  Conclusion conclusion;
  model::Candidates candidates;  // which the conclusion points to
};

Asked asked_of(unsigned seed, double acceleration_per_wind, double duration = 70.0) {
  static const model::Vehicle vehicle = [] {
    model::Vehicle one = test::vehicle_from_repository("bluerov2");
    model::add_candidate("wind_speed", one.candidates);
    return one;
  }();
  auto dive =
      test::fly(vehicle, {.duration = duration, .seed = seed, .force = 0.03, .outside = [&](double t, const auto&) {
                            return Vector6d{acceleration_per_wind * (wind(t) - 5.0) * Vector6d::Unit(1)};
                          }});
  for (const double t : dive.trial.t)
    dive.trial.columns.emplace_back(Eigen::Vector2d{wind(t + 0.5 * dive.trial.dt), 0.0});
  dive.trial.column_units = {"m/s"};
  Asked asked{.conclusion = {}, .candidates = model::candidates_of(vehicle, {&dive.trial, 1})};
  asked.conclusion = infer(vehicle, {&dive.trial, 1}, {.candidates = asked.candidates.pointers()}, Progress{});
  return asked;
}

}  // namespace

TEST_CASE("candidates: a hidden force that follows a column is named, with its coefficient") {
  constexpr double kPerWind = 0.06;                  // m/s^2 per m/s
  const Asked asked = asked_of(5, kPerWind, 280.0);  // long enough for evidence that makes a claim
  const Found& found = asked.conclusion.found;
  REQUIRE(!found.odds.empty());
  CAPTURE(found.odds.front());
  CAPTURE(found.probability.front());
  CAPTURE(found.rival.front());
  CHECK(asked.conclusion.verdict == Verdict::effect);
  REQUIRE(found.best.names == std::vector<std::string>{"column wind_speed"});
  const likelihood::Fit& fit = found.best.fit;
  const model::ActiveEffect& active = fit.hypothesis.model.effects.front();
  CHECK(active.variant_name.starts_with("Y, about "));
  // The true mass is within a few percent of the fitted one: m_Y c is the force.
  double mass = 0.0, sigma = 0.0;
  const Eigen::VectorXd sigmas = fit.sigma();
  for (std::size_t j = 0; j < fit.numbers.size(); ++j) {
    if (fit.numbers[j].name == "m_Y") mass = value(fit.hypothesis, fit.numbers[j]);
    if (fit.numbers[j].name == "column wind_speed.c_Y") {
      sigma = sigmas[static_cast<Eigen::Index>(j)];
      CHECK(fit.numbers[j].unit == "N/(m/s)");
    }
  }
  REQUIRE(mass > 0.0);
  CHECK(sigma > 0.0);
  CHECK(active.theta[1] == doctest::Approx(kPerWind * mass).epsilon(0.1));
}

TEST_CASE("candidates: a column that nothing follows is not named") {
  for (const unsigned seed : {11U, 12U, 13U}) {
    CAPTURE(seed);
    const Asked asked = asked_of(seed, 0.0);
    CHECK(asked.conclusion.verdict == Verdict::adequate);
    CHECK(asked.conclusion.found.best.names.empty());
  }
}

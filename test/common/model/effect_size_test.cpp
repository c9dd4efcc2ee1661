// Ordinary sizes on larger vehicles: units read right, Froude's similarity kept, small craft as they were.
#include "common/model/effect_size.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/model/vehicle.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom::model;

TEST_CASE("effect size: quantities grow with the mass as their units say") {
  struct Case {
    const char* unit;
    double growth;
  };
  for (const Case& each :
       {Case{"N", 1.0}, Case{"kg", 1.0}, Case{"m", 1.0 / 3.0}, Case{"s", 1.0 / 6.0}, Case{"rad", 0.0}, Case{"", 0.0},
        Case{"m/s", 1.0 / 6.0}, Case{"rad/s", -1.0 / 6.0}, Case{"N m", 4.0 / 3.0}, Case{"N/m", 2.0 / 3.0},
        Case{"N/(m/s)", 5.0 / 6.0}, Case{"N/(m/s)^2", 2.0 / 3.0}, Case{"N m/(rad/s)", 1.5},
        Case{"N m/(rad/s)^2", 5.0 / 3.0}, Case{"kg m^2", 5.0 / 3.0}, Case{"N^(1/2)/(m/s)", 1.0 / 3.0},
        Case{"N/(m/s)^2/m", 1.0 / 3.0}}) {
    CHECK_MESSAGE(growth_of(each.unit) == doctest::Approx(each.growth), each.unit);
  }
}

TEST_CASE("effect size: every effect's units are read, and a twelfth of a unit is nowhere left over") {
  for (const Effect* effect : all_effects()) {
    for (std::size_t i = 0; i < effect->parameters().size(); ++i) {
      const double sixths = 6.0 * growth_of(effect->unit(0, i));
      CHECK_MESSAGE(std::abs(sixths - std::round(sixths)) < 1e-9, effect->name() << " " << effect->unit(0, i));
    }
  }
}

TEST_CASE("effect size: small craft and unknown masses keep what effects state, large ones have more of it") {
  const Effect& tether = *find_effect("tether_tension");
  Vehicle vehicle;
  for (const double mass : {0.0, 8.0, 30.0}) {
    vehicle.mass = mass;
    CHECK(parameter_of(tether, 0, 0, vehicle).sigma == tether.parameters()[0].sigma);
    CHECK(parameter_of(tether, 0, 0, vehicle).high == tether.parameters()[0].high);
  }
  vehicle.mass = 30.0 * 1e6;
  const auto numbers = parameters_of(tether, 0, vehicle);
  CHECK(numbers[0].sigma == doctest::Approx(1e4 * tether.parameters()[0].sigma));  // N/m
  CHECK(numbers[0].low == 0.0);
  CHECK(numbers[1].high == doctest::Approx(100.0 * tether.parameters()[1].high));  // m
  CHECK(std::isinf(numbers[2].high));
  // What sensors do, and when something happened, does not grow.
  CHECK(parameter_of(*find_effect("sensor_latency"), 0, 0, vehicle).high ==
        find_effect("sensor_latency")->parameters()[0].high);
  const Effect& failure = *find_effect("thruster_failure");
  CHECK(parameter_of(failure, 0, 1, vehicle).sigma == failure.parameters()[1].sigma);
}

TEST_CASE("effect size: a search that a limit has stopped, and one that found nothing, are told from one that found") {
  const Vehicle vehicle = fathom::test::vehicle_from_repository("seabotix_lbv150");
  const auto stopped = [&](const char* name, const std::vector<double>& theta, int variant = 0) {
    return stopped_at_limit(*find_effect(name), variant, theta, vehicle);
  };
  CHECK_FALSE(stopped("thrust_overshoot", {0.4, 1.0}));
  CHECK(stopped("thrust_overshoot", {0.98, 1.0}));
  CHECK(stopped("thrust_overshoot", {1.02, 1.0}));  // beyond: by an estimate that knows no limits
  CHECK(stopped("thrust_overshoot", {0.4, 0.05}));
  CHECK(stopped("thrust_overshoot", {0.0, 1.0}));  // no effect at all
  CHECK_FALSE(
      stopped("tether_tension", {5.0, 0.0, 2.0, 0.0, 0.0}));  // never slack, made fast in the plane of the origin
  CHECK_FALSE(stopped("payload_change", {0.0, -3.0, 0.0}));
  CHECK(stopped("payload_change", {0.0, 0.0, 50.0}));
  CHECK_FALSE(stopped("thruster_lag", {0.1, 0.0}));  // the second number has no part in the plain form
}

TEST_CASE("effect size: a memory is filled over four and a half time constants at least") {
  CHECK(run_in_for(0.1) == 3.0);
  CHECK(run_in_for(0.5) == 3.0);
  for (const double T : {1.1, 1.7, 4.5, 9.0}) {
    CHECK(run_in_for(T) >= 4.5 * T);
    CHECK(run_in_for(T) <= 6.5 * T);
    CHECK(run_in_for(T * 1.0001) == run_in_for(T));
  }
  CHECK(run_in_for(1e3) == doctest::Approx(48.0));
}

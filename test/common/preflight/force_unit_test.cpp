// Forces in another unit show as inertias that the vehicle cannot have.
#include "common/preflight/force_unit.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/preflight/implausible.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::preflight;

TEST_CASE("force unit: named when all inertias are far from the file's, silent when one is or all nearly fit") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const auto fitted = [&](double all, double yaw) {
    std::vector<NamedValue> values;
    for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
      const double factor = all * (vehicle.parameters[i] == "I_Z" ? yaw : 1.0);
      values.push_back({.name = vehicle.parameters[i], .value = factor * vehicle.priors[i].mean});
    }
    return values;
  };
  CHECK_FALSE(compare_inertia(vehicle, fitted(1.0, 1.0)));
  CHECK_FALSE(compare_inertia(vehicle, fitted(0.5, 1.0)));
  CHECK_FALSE(compare_inertia(vehicle, fitted(1.2, 1e-3)));
  CHECK_FALSE(compare_inertia(vehicle, {}));
  const auto kilo = compare_inertia(vehicle, fitted(1.1e-3, 0.4));
  REQUIRE(kilo);
  CHECK(kilo->size == doctest::Approx(1.1e-3).epsilon(1e-6));
  CHECK(kilo->action.ends_with("as if the forces are in kN"));
  const auto kgf = compare_inertia(vehicle, fitted(0.11, 1.0));
  REQUIRE(kgf);
  CHECK(kgf->action.ends_with("as if the forces are in kgf"));
  const auto strange = compare_inertia(vehicle, fitted(30.0, 1.0));
  REQUIRE(strange);
  CHECK(strange->action.find("as if") == std::string::npos);
}

TEST_CASE("force unit: thrust that is filed four times too strong is one cause, and its size is said") {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2_heavy");
  std::vector<NamedValue> values;
  const auto scatter = [](std::size_t i) { return i % 2 == 0 ? 1.2 : 0.85; };  // as of added mass that is guessed
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i)
    values.push_back({.name = vehicle.parameters[i], .value = 4.0 * scatter(i) * vehicle.priors[i].mean});
  const auto four = compare_inertia(vehicle, values);
  REQUIRE(four);
  CHECK(four->size == doctest::Approx(4.0).epsilon(0.25));
  CHECK(four->action.find("all thrust about 0.2") != std::string::npos);
  // Where the file only guesses at the added water it takes more.
  const std::vector<model::Prior> known = vehicle.priors;
  for (model::Prior& prior : vehicle.priors) prior.sigma = 2.0 * std::abs(prior.mean) + 1.0;
  CHECK_FALSE(compare_inertia(vehicle, values));
  vehicle.priors = known;
  // Two of them off the same way are no factor on all.
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool off = values[i].name == "m_X" || values[i].name == "m_Y";
    values[i].value = (off ? 8.0 : 1.0) * vehicle.priors[i].mean;
  }
  CHECK_FALSE(compare_inertia(vehicle, values));
}

TEST_CASE("implausible: a mass, a moment and a drag that no such craft has are named with what would be usual") {
  model::Vehicle vehicle;
  vehicle.mass = 13.5;
  vehicle.inertia = {0.3, 0.3, 0.4};
  vehicle.water_density = 1000.0;
  const auto found = [&](const char* name, double value, double std) {
    const NamedValue one{.name = name, .value = value, .std = std, .unit = "u"};
    return implausible_numbers(vehicle, {&one, 1});
  };
  const auto heavy = found("m_Z", 104.0, 3.0);
  REQUIRE(heavy.size() == 1);
  CHECK(heavy[0].signal == "m_Z");
  CHECK(heavy[0].evidence == "104 +- 3 u for a craft of 13.5 kg: with the water that it moves 12.2 to 81 kg");
  CHECK(found("m_Z", 40.0, 1.0).empty());
  CHECK(found("m_X", 5.0, 1.0).size() == 1);  // lighter than the craft
  CHECK(found("m_X", 5.0, 6.0).empty());      // not known well enough to say so
  CHECK(found("I_Z", 9.0, 0.1).size() == 1);
  CHECK(found("I_Z", 0.9, 0.1).empty());
  CHECK(found("Y_v|v|", 30.0, 5.0).size() == 1);  // feeds the motion
  CHECK(found("Y_v|v|", -2000.0, 50.0).size() == 1);
  CHECK(found("Y_v|v|", -120.0, 50.0).empty());
  CHECK(found("Y_v", 30.0, 5.0).empty());  // a linear term beside a quadratic one may have either sign
  vehicle.parameters = {"m_X"};
  vehicle.priors = {{.mean = 6.0, .sigma = 1.0}};  // another's measurement of the same craft
  CHECK(found("m_X", 5.6, 0.05).empty());
  vehicle.mass = 0.0;
  CHECK(found("m_Z", 104.0, 3.0).empty());
}

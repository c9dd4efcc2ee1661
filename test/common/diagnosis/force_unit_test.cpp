// Forces in another unit show as inertias that the vehicle cannot have.
#include "common/diagnosis/force_unit.hpp"

#include <doctest/doctest.h>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

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

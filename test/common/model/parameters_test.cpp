// The parameter table against the naming conventions, written independently.
#include "common/model/parameters.hpp"

#include <doctest/doctest.h>

#include <string>

#include "common/model/vehicle.hpp"

using namespace fathom;

TEST_CASE("base parameters: every name finds its own parameter again") {
  REQUIRE(model::base_parameters().size() == 22);
  int expected = 0;
  for (const model::BaseParameter parameter : model::base_parameters()) {
    CHECK(model::index(parameter) == expected++);
    CHECK(model::parameter_from_name(model::name(parameter)) == parameter);
    CHECK_FALSE(model::unit(parameter).empty());
  }
  CHECK_FALSE(model::parameter_from_name("X_uu").has_value());
  CHECK_FALSE(model::parameter_from_name("").has_value());
}

TEST_CASE("base parameters: drag is named by its axis and velocity, dissipates, and masses are positive") {
  for (std::size_t i = 0; i < 6; ++i) {
    const std::string velocity = model::kVelocityNames[i];
    const std::string linear = std::string{model::kAxisNames[i]} + "_" + velocity;
    for (const std::string& name : {linear, linear + "|" + velocity + "|"}) {
      const auto parameter = model::parameter_from_name(name);
      REQUIRE(parameter.has_value());
      CHECK(model::axis(*parameter) == static_cast<int>(i));
      CHECK(model::sign_constraint(*parameter) == -1);
    }
    const auto mass = model::parameter_from_name((i < 3 ? "m_" : "I_") + std::string{model::kAxisNames[i % 3]});
    REQUIRE(mass.has_value());
    CHECK(model::axis(*mass) == static_cast<int>(i));
    CHECK(model::sign_constraint(*mass) == 1);
  }
  CHECK(model::sign_constraint(model::BaseParameter::W_B) == 0);
}

TEST_CASE("parameters: units of coefficients follow load and velocity") {
  CHECK(model::drag_unit(0, 0, 2) == model::unit(model::BaseParameter::X_uu));
  CHECK(model::drag_unit(5, 5, 1) == model::unit(model::BaseParameter::N_r));
  CHECK(model::drag_unit(1, 5, 1) == "N/(rad/s)");
  CHECK(model::drag_unit(4, 2, 3) == "N m/(m/s)^3");
  CHECK(model::inertia_unit(0, 2) == model::unit(model::BaseParameter::m_X));
  CHECK(model::inertia_unit(1, 5) == "kg m");
  CHECK(model::inertia_unit(3, 5) == model::unit(model::BaseParameter::I_Z));
}

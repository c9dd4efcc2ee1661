#include "common/base/units.hpp"

#include <doctest/doctest.h>

#include <numbers>
#include <string>

#include "common/base/error.hpp"

using fathom::InputError;
using fathom::unit_factor;

namespace {
constexpr double kRounding = 1e-14;  // a handful of multiplications
}

TEST_CASE("units: products, quotients, powers and parentheses come out as computed by hand") {
  CHECK(unit_factor("kg m^2", "kg m^2") == 1.0);
  CHECK(unit_factor("g cm^2", "kg m^2") == doctest::Approx(1e-7).epsilon(kRounding));
  CHECK(unit_factor("N/(m/s)^2", "kg/m") == 1.0);
  CHECK(unit_factor("N m/(rad/s)", "N m/(rad/s)") == 1.0);
  CHECK(unit_factor("Nm", "N m") == 1.0);
  CHECK(unit_factor("mbar", "Pa") == 100.0);
  CHECK(unit_factor("km/h", "m/s") == doctest::Approx(1.0 / 3.6).epsilon(kRounding));
  CHECK(unit_factor("us", "s") == 1e-6);
  CHECK(unit_factor("s", "us") == doctest::Approx(1e6).epsilon(kRounding));
  CHECK(unit_factor("V A", "W") == 1.0);
  CHECK(unit_factor("cc", "m^3") == 1e-6);
  CHECK(unit_factor("L/min", "m^3/s") == doctest::Approx(1e-3 / 60.0).epsilon(kRounding));
  CHECK(unit_factor("in", "mm") == doctest::Approx(25.4).epsilon(kRounding));
  CHECK(unit_factor("N*m", "J") == 1.0);
  CHECK(unit_factor("m s^-2", "m/s^2") == 1.0);
  CHECK(unit_factor("", "") == 1.0);
  CHECK(unit_factor("%", "") == 0.01);
}

TEST_CASE("units: an angle is its own dimension only where an angle or its rate is wanted") {
  CHECK(unit_factor("deg", "rad") == doctest::Approx(std::numbers::pi / 180.0).epsilon(kRounding));
  CHECK(unit_factor("deg/s", "rad/s") == doctest::Approx(std::numbers::pi / 180.0).epsilon(kRounding));
  CHECK(unit_factor("rpm", "rad/s") == doctest::Approx(std::numbers::pi / 30.0).epsilon(kRounding));
  CHECK(unit_factor("rev/s", "rad/s") == doctest::Approx(2.0 * std::numbers::pi).epsilon(kRounding));
  CHECK(unit_factor("rps", "rad/s") == unit_factor("rev/s", "rad/s"));
  CHECK(unit_factor("N m s", "N m/(rad/s)") == 1.0);
  CHECK(unit_factor("N m/(deg/s)", "N m/(rad/s)") == doctest::Approx(180.0 / std::numbers::pi).epsilon(kRounding));
  CHECK_THROWS_AS(static_cast<void>(unit_factor("m", "rad")), InputError);
  CHECK_THROWS_AS(static_cast<void>(unit_factor("Hz", "rad/s")), InputError);
  CHECK_THROWS_AS(static_cast<void>(unit_factor("", "rad")), InputError);
}

TEST_CASE("units: the wrong dimension, an unknown symbol and broken text are refused with a sentence") {
  const auto message = [](const char* from, const char* to) -> std::string {
    try {
      static_cast<void>(unit_factor(from, to));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(message("g", "m") == "unit 'g' does not fit: expected 'm'");
  CHECK(message("", "kg") == "the unit is missing: expected 'kg'");
  CHECK(message("kg", "") == "unit 'kg' does not fit: a plain number is expected");
  CHECK(message("lbs", "kg") == "unit 'lbs': 'lbs' is not a known unit");
  CHECK(message("N/(m/s", "N") == "unit 'N/(m/s': missing ')'");
  CHECK(message("N)", "N") == "unit 'N)': unexpected ')'");
  CHECK(message("m^x", "m") == "unit 'm^x': '^' needs a small whole number other than 0");
  CHECK(message("C", "K") == "unit 'C' does not fit: expected 'K'");
  for (const char* text : {"/", "m/", "^2", "m^", "m^99", "((((((((((((((((((((m", "m..", "2 m"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(static_cast<void>(unit_factor(text, "m")), InputError);
  }
}

#include "common/model/priors/physical_bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace fathom::model {
namespace {

// The largest ship there has been: 458 m long, 69 m wide, 25 m deep in the water, 6.6e8 kg loaded. The smallest vehicle
// that anybody tests: some grams, some centimetres.
constexpr std::string_view kShip = "the largest ship there was is 458 m long and 6.6e8 kg heavy";
constexpr std::string_view kAdded =
    "ten times the largest ship: the water that moves with a hull is about as heavy as it";
constexpr std::string_view kTurned = "ten times the largest ship turning about its middle, 6.6e8 kg (458 m)^2 / 12";
// 1/2 rho A Cd of its side: 500 * 458 * 25 = 6e6; linear and cubic ones are as large at 1 m/s.
constexpr std::string_view kDragForce = "a hundred times the largest ship's side as a plate, 1/2 rho 458 m 25 m";
// 1/2 rho 25 L^4 / 32 about its middle: 2e13.
constexpr std::string_view kDragMoment =
    "a hundred times the largest ship's side turning as a plate, 1/2 rho 25 m (458 m)^4 / 32";
constexpr std::string_view kPlaces = "nothing on a vehicle is farther from its origin than the largest ship is long";
constexpr std::string_view kTurn = "two full turns say all that an angle can";
constexpr std::string_view kPlain = "nothing without a unit in a vehicle file is as large";

constexpr std::array kBounds{
    PhysicalBound{"mass", "kg", 1e-3, 1e9, kShip},
    PhysicalBound{"water_density", "kg/m^3", 900.0, 1400.0, "boiling water has 958 kg/m^3, the Dead Sea 1240 kg/m^3"},
    PhysicalBound{"buoyancy", "N", 1e-2, 1e10, kShip},
    PhysicalBound{"nominal_voltage", "V", 0.5, 2e4, "one cell gives 1 V, the largest ships' drives use 11 kV"},
    PhysicalBound{"voltage", "V", 0.5, 2e4, "one cell gives 1 V, the largest ships' drives use 11 kV"},
    PhysicalBound{"largest_thrust", "N", 1e-4, 1e7, "the largest propellers push with some 5 MN"},
    PhysicalBound{"largest", "N", 1e-4, 1e7, "the largest propellers push with some 5 MN"},
    PhysicalBound{"force", "N", 0.0, 1e7, "the largest propellers push with some 5 MN"},
    PhysicalBound{"hull", "m", 1e-3, 500.0, kShip},
    PhysicalBound{"inertia", "kg m^2", 1e-9, 1e14, kTurned},
    PhysicalBound{"neutral", "us", 1.0, 2e4, "a servo's pulse comes every 20 ms"},
    PhysicalBound{"pwm", "us", 0.0, 2e4, "a servo's pulse comes every 20 ms"},
    PhysicalBound{"voltage_exponent", "", 0.0, 4.0,
                  "thrust goes with the square of the voltage at most, and some doubt"},
    PhysicalBound{"position", "m", 0.0, 500.0, kPlaces},
    PhysicalBound{"emitter", "m", 0.0, 500.0, kPlaces},
    PhysicalBound{"centre_of_buoyancy", "m", 0.0, 500.0, kPlaces},
    PhysicalBound{"centre_of_mass", "m", 0.0, 500.0, kPlaces},
    PhysicalBound{"length", "m", 1e-3, 2e4, "a hull's or a chain's: the deepest sea has 11 km"},
    PhysicalBound{"diameter", "m", 1e-5, 10.0, "of a line: from a hair to a pipeline"},
    PhysicalBound{"paid_out", "m", 1e-3, 2e4, "the deepest sea has 11 km"},
    PhysicalBound{"seabed", "m", 0.0, 1.2e4, "the deepest sea has 11 km"},
    PhysicalBound{"drag_coefficient", "", 1e-4, 100.0, "a plate has 1.2, a rough line along itself 0.01"},
    PhysicalBound{"friction", "", 0.0, 10.0, "rubber on concrete has 1"},
    PhysicalBound{"weight", "N/m", 1e-6, 1e5, "the heaviest anchor chains weigh 6 kN/m"},
    PhysicalBound{"focal", "", 1.0, 1e6, "pixels: a lens of 1 m before pixels of 1 um"},
    PhysicalBound{"*", "", 0.0, 1e6, kPlain},
    PhysicalBound{"*", "m", 0.0, 2e4, "the deepest sea has 11 km"},
    PhysicalBound{"*", "m^2", 0.0, 4e4, "the largest ship's side has 458 m by some 60 m"},
    PhysicalBound{"*", "1/rad", 0.0, 100.0, "a wing of infinite span lifts 2 pi per radian"},
    PhysicalBound{"*", "rad", 0.0, 12.6, kTurn},
    PhysicalBound{"*", "s", 0.0, 1e7, "four months"},
    PhysicalBound{"*", "V", 0.0, 2e4, "the largest ships' drives use 11 kV"},
    PhysicalBound{"*", "m/s", 0.0, 200.0, "the fastest torpedoes run 100 m/s"},
    PhysicalBound{"*", "kg", 0.0, 1e10, kAdded},
    PhysicalBound{"*", "kg m", 0.0, 1e12, kAdded},
    PhysicalBound{"*", "kg m^2", 0.0, 1e15, kTurned},
    PhysicalBound{"*", "N", 0.0, 1e10, kShip},
    PhysicalBound{"*", "N m", 0.0, 1e13, kShip},
    PhysicalBound{"*", "N/m", 0.0, 1e9, kShip},
    PhysicalBound{"*", "N/(m/s)", 0.0, 1e9, kDragForce},
    PhysicalBound{"*", "N/(m/s)^2", 0.0, 1e9, kDragForce},
    PhysicalBound{"*", "N m/(rad/s)", 0.0, 1e16, kDragMoment},
    PhysicalBound{"*", "N m/(rad/s)^2", 0.0, 1e16, kDragMoment},
};

std::string brief(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace

std::span<const PhysicalBound> physical_bounds() { return kBounds; }

std::string beyond_physics(const std::string& key, const std::string& unit, double value) {
  const auto row = [&](std::string_view name) {
    return std::ranges::find_if(kBounds, [&](const auto& each) { return each.key == name && each.unit == unit; });
  };
  const auto* bound = row(key);
  if (bound == kBounds.end()) bound = row("*");
  if (bound == kBounds.end())
    throw std::logic_error("no physical bound for '" + key + "' in " + unit + ": add a row to physical_bounds.cpp");
  const double magnitude = std::abs(value);
  const std::string spaced = unit.empty() ? "" : " " + unit;
  if (magnitude > bound->most) {
    return "'" + key + "' of " + brief(value) + spaced + " is beyond what there is: at most " + brief(bound->most) +
           spaced + " (" + std::string{bound->reason} + "); is the unit right?";
  }
  if (value > 0.0 && value < bound->least) {
    return "'" + key + "' of " + brief(value) + spaced + " is below what there is: at least " + brief(bound->least) +
           spaced + " (" + std::string{bound->reason} + "); is the unit right?";
  }
  return {};
}

}  // namespace fathom::model

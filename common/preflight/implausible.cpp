#include "common/preflight/implausible.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include "common/model/parameters.hpp"

namespace fathom::preflight {
namespace {

constexpr double kLightest = 0.9;     // of the mass: water adds to it; a tenth for what a file rounds or leaves out
constexpr double kHeaviest = 6.0;     // of the mass: a plate across the flow moves four to five times its own in water
constexpr double kMoment = 8.0;       // either way of a file's moment of inertia, with the water's
constexpr double kBluntest = 3.0;     // drag coefficient of an open frame across the flow, on its largest side
constexpr double kLargestSide = 4.0;  // of volume^(2/3): of a hull six times as long as wide
constexpr double kDeviations = 2.0;

struct Usual {
  double low, high;
  std::string words;
};

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

/// `expected`: the mean of the file's prior, which may be another's measurement.
std::optional<Usual> usual(model::BaseParameter parameter, double expected, const model::Vehicle& vehicle) {
  using enum model::BaseParameter;
  const int axis = model::axis(parameter);
  switch (parameter) {
    case m_X:
    case m_Y:
    case m_Z: {
      const double low = kLightest * std::min(vehicle.mass, expected), high = kHeaviest * vehicle.mass;
      return Usual{low, high,
                   "for a craft of " + number(vehicle.mass) + " kg: with the water that it moves " + number(low) +
                       " to " + number(high) + " kg"};
    }
    case I_X:
    case I_Y:
    case I_Z: {
      const double own = vehicle.inertia[axis - 3];
      if (!(own > 0.0)) return std::nullopt;
      return Usual{own / kMoment, own * kMoment,
                   "for a craft of " + number(own) + " kg m^2: with the water that it turns " + number(own / kMoment) +
                       " to " + number(own * kMoment) + " kg m^2"};
    }
    case X_uu:
    case Y_vv:
    case Z_ww: {
      if (!(vehicle.water_density > 0.0)) return std::nullopt;
      const double volume = vehicle.mass / vehicle.water_density;
      const double most = 0.5 * vehicle.water_density * kBluntest * kLargestSide * std::cbrt(volume * volume);
      return Usual{-most, 0.0,
                   "for a craft of " + number(vehicle.mass) + " kg: between 0 and " + number(-most) + " " +
                       std::string{model::unit(parameter)}};
    }
    default:
      return std::nullopt;
  }
}

}  // namespace

std::vector<ConsistencyFinding> implausible_numbers(const model::Vehicle& vehicle,
                                                    std::span<const NamedValue> parameters) {
  std::vector<ConsistencyFinding> findings;
  if (!(vehicle.mass > 0.0)) return findings;
  for (const NamedValue& one : parameters) {
    const auto parameter = model::parameter_from_name(one.name);
    if (!parameter) continue;
    const auto enabled = std::ranges::find(vehicle.parameters, one.name);
    const auto place = static_cast<std::size_t>(enabled - vehicle.parameters.begin());
    const double expected = enabled == vehicle.parameters.end() ? vehicle.mass : vehicle.priors[place].mean;
    const std::optional<Usual> range = usual(*parameter, expected, vehicle);
    if (!range) continue;
    const double doubt = std::isfinite(one.std) ? kDeviations * one.std : 0.0;
    if (one.value + doubt >= range->low && one.value - doubt <= range->high) continue;
    findings.push_back({.run = "all",
                        .signal = one.name,
                        .reference = "vehicle file",
                        .finding = "implausible",
                        .size = one.value,
                        .unit = one.unit,
                        .evidence = number(one.value) + " +- " + number(one.std) + " " + one.unit + " " + range->words,
                        .action = "not corrected: the model predicts with it, but what it is made of is not this "
                                  "craft's; look at the thrust along this axis"});
  }
  return findings;
}

}  // namespace fathom::preflight

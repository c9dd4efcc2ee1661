// Intervals by profile likelihood: that of the standard deviation where the cost is a parabola, lopsided where it is
// not, and holding the truth as often as they say.
#include "common/identification/profile.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "test/support/timing.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

struct Profiled {
  FitResult fit;
  NamedValue number;
};

/// Fits the dive with its own effect, beginning at the truth.
Profiled profiled(const model::Vehicle& vehicle, const test::DiveSettings& settings, const std::string& name) {
  const test::VirtualDive dive = test::make_dive(vehicle, settings);
  FitSettings fits;
  fits.window = 5.0;
  fits.threads = 2;
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, fits};
  Profiled result{problem.fit(dive.truth), {}};
  problem.add_covariance(result.fit);
  add_profiles(problem, result.fit);
  const auto all = result.fit.parameters();
  const auto found = std::ranges::find(all, name, &NamedValue::name);
  REQUIRE(found != all.end());
  result.number = *found;
  return result;
}

}  // namespace

TEST_CASE("profile: where the cost is a parabola it ends where the standard deviation says") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::DiveSettings settings{.duration = 120.0, .seed = 4};
  settings.effects = {test::active("fluid_memory", {12.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0}, 0)};
  const auto [fit, memory] = profiled(vehicle, settings, "fluid_memory.time_constant");
  CHECK(fit.t95() > kNormal95);
  const std::vector<NamedValue> all = fit.parameters();
  for (const NamedValue& value : all) {
    CAPTURE(value.name);
    const auto place = static_cast<std::size_t>(&value - all.data());
    CHECK(fit.interval95[place].has_value() == (value.name == memory.name));
  }
  // Well determined: within a third of the normal interval on either side.
  const auto [low, high] = memory.range95();
  REQUIRE(memory.std < 0.2 * memory.value);
  CHECK(memory.value - low == doctest::Approx(fit.t95() * memory.std).epsilon(0.33));
  CHECK(high - memory.value == doctest::Approx(fit.t95() * memory.std).epsilon(0.33));
}

TEST_CASE("profile: a time constant that the data hardly shows may be far longer, not far shorter") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::DiveSettings settings{.duration = 120.0, .seed = 4, .velocity_noise = 0.06, .rate_noise = 0.06};
  settings.effects = {test::active("fluid_memory", {12.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0}, 0)};
  const auto [fit, memory] = profiled(vehicle, settings, "fluid_memory.time_constant");
  const auto [low, high] = memory.range95();
  CHECK(high - memory.value > 1.25 * (memory.value - low));
}

TEST_CASE("profile: holds the truth as often as it says") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const unsigned dives = test::seeds(24);
  unsigned held = 0;
  double widths = 0.0;  // over what the standard deviation says
  for (unsigned seed = 1; seed <= dives; ++seed) {
    test::DiveSettings settings{.duration = 90.0, .seed = seed, .velocity_noise = 0.015, .rate_noise = 0.015};
    settings.effects = {test::active("fluid_memory", {12.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0}, 0)};
    const auto [fit, memory] = profiled(vehicle, settings, "fluid_memory.time_constant");
    const auto [low, high] = memory.range95();
    held += low <= 2.0 && high >= 2.0 ? 1 : 0;
    widths += (high - low) / (2.0 * fit.t95() * memory.std) / dives;
  }
  MESSAGE("95 % intervals that hold the truth: " << held << " of " << dives);
  // Fewer than 20 of 24 has a probability of 0.6 % at 95 %; few windows cost a little.
  CHECK(held >= (dives * 5) / 6);
  CHECK(widths < 1.5);
}

TEST_CASE("profile: a number that a bound stops neither widens nor narrows the interval of another") {
  // Without linear drag in truth, half of the fits want it positive, which its bound forbids.
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    if (vehicle.parameters[i] == "X_u") vehicle.priors[i].mean = 0.0;
  }
  test::DiveSettings settings{.duration = 120.0, .seed = 6};
  settings.effects = {test::active("fluid_memory", {12.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0}, 0)};
  const auto [fit, memory] = profiled(vehicle, settings, "fluid_memory.time_constant");
  const auto [low, high] = memory.range95();
  const std::vector<NamedValue> all = fit.parameters();
  const auto drag = std::ranges::find(all, "X_u", &NamedValue::name);
  REQUIRE(drag != all.end());
  REQUIRE(drag->value > -0.1 * drag->std);  // it is at its bound, or all but there
  CHECK(high - low == doctest::Approx(2.0 * fit.t95() * memory.std).epsilon(0.25));
  CHECK(low < 1.0);
  CHECK(high > 1.0);
}

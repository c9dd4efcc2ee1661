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
  settings.effects = {test::active("fluid_memory", {12.0, 1.0}, 0)};
  const auto [fit, memory] = profiled(vehicle, settings, "fluid_memory.time_constant");
  CHECK(fit.t95() > kNormal95);
  for (const NamedValue& value : fit.parameters()) {
    CAPTURE(value.name);
    const double half = fit.t95() * value.std;  // of all others
    if (value.name != memory.name) CHECK(value.range95()[1] == doctest::Approx(value.value + half));
  }
  // Well determined: within a third of the normal interval on either side.
  const auto [low, high] = memory.range95();
  REQUIRE(memory.std < 0.2 * memory.value);
  CHECK(memory.value - low == doctest::Approx(fit.t95() * memory.std).epsilon(0.33));
  CHECK(high - memory.value == doctest::Approx(fit.t95() * memory.std).epsilon(0.33));
}

TEST_CASE("profile: a time constant that the data hardly shows may be far longer, not far shorter") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::DiveSettings settings{.duration = 120.0, .seed = 4, .velocity_noise = 0.03, .rate_noise = 0.03};
  settings.effects = {test::active("fluid_memory", {12.0, 4.0}, 0)};
  const auto [fit, memory] = profiled(vehicle, settings, "fluid_memory.time_constant");
  const auto [low, high] = memory.range95();
  CAPTURE(memory.value);
  CAPTURE(memory.std);
  CAPTURE(low);
  CAPTURE(high);
  CHECK(low > 0.0);
  CHECK(high - memory.value > 1.25 * (memory.value - low));
  CHECK(high <= 30.0);  // the physical bound
}

TEST_CASE("profile: holds the truth as often as it says") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const unsigned dives = test::seeds(24);
  unsigned held = 0;
  for (unsigned seed = 1; seed <= dives; ++seed) {
    test::DiveSettings settings{.duration = 90.0, .seed = seed, .velocity_noise = 0.015, .rate_noise = 0.015};
    settings.effects = {test::active("fluid_memory", {12.0, 2.0}, 0)};
    const auto [low, high] = profiled(vehicle, settings, "fluid_memory.time_constant").number.range95();
    held += low <= 2.0 && high >= 2.0 ? 1 : 0;
  }
  MESSAGE("95 % intervals that hold the truth: " << held << " of " << dives);
  // Fewer than 20 of 24 has a probability of 0.6 % at 95 %; few windows cost a little.
  CHECK(held >= (dives * 5) / 6);
}

// A dead axis is told from one that rests, that is read coarsely, or that is not measured.
#include "common/estimation/freezes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <random>

using namespace fathom;
using namespace fathom::estimation;

namespace {

constexpr double kStep = 0.02;  // s
constexpr double kNoise = 0.005, kLength = 100.0;

/// Three axes that swing and are noisy; `first` alters the first one: (t, value) to value.
Series swinging(const std::function<double(double, double)>& first) {
  std::mt19937 random{7};
  std::normal_distribution<double> noise{0.0, kNoise};
  Series series;
  for (double t = 0.0; t < kLength; t += kStep) {
    series.t.push_back(t);
    const double u = 0.3 * std::sin(0.4 * t) + noise(random);
    series.x.emplace_back(first(t, u), 0.2 * std::sin(0.7 * t) + noise(random), noise(random));
  }
  return series;
}

FrozenAxis frozen(const Series& series, int axis) {
  return frozen_axis(series, axis, std::vector<std::uint8_t>(series.size(), 0));
}

/// Keeps the value that it has at `from` until `until`.
std::function<double(double, double)> stuck(double from, double until) {
  return [=, held = 0.0](double t, double u) mutable {
    if (t < from || t >= until) held = u;
    return held;
  };
}

}  // namespace

TEST_CASE("frozen axis: found when it comes back, when it does not, and when it dies to zero") {
  const FrozenAxis between = frozen(swinging(stuck(30.0, 50.0)), 0);
  CHECK(between.longest == doctest::Approx(20.0).epsilon(0.01));
  CHECK(between.begin == doctest::Approx(30.0).epsilon(0.01));
  CHECK(between.samples[static_cast<std::size_t>(40.0 / kStep)] == 1);
  CHECK(between.samples[static_cast<std::size_t>(60.0 / kStep)] == 0);
  CHECK(frozen(swinging(stuck(52.0, 1e9)), 0).longest == doctest::Approx(kLength - 52.0).epsilon(0.01));
  CHECK(frozen(swinging([](double t, double u) { return t < 52.0 ? u : 0.0; }), 0).longest > 40.0);
  CHECK(frozen(swinging(stuck(54.98, 1e9)), 0).longest > 40.0);  // as it passes through zero, noise and all
}

TEST_CASE("frozen axis: the others are not accused, nor what is known already") {
  const Series series = swinging(stuck(30.0, 50.0));
  CHECK(frozen(series, 1).longest == 0.0);
  CHECK(frozen(series, 2).longest == 0.0);
  CHECK(frozen_axis(series, 0, std::vector<std::uint8_t>(series.size(), 1)).longest == 0.0);
}

TEST_CASE("frozen axis: rest, a coarse reading and an axis that is not measured are none") {
  CHECK(frozen(swinging([](double, double) { return 0.0; }), 0).longest == 0.0);
  CHECK(frozen(swinging([](double, double) { return 1.7; }), 0).longest == 0.0);
  const auto coarse = [](double, double u) { return 0.2 * std::round(u / 0.2); };
  CHECK(frozen(swinging(coarse), 0).longest == 0.0);
  const auto rests = [](double t, double u) { return t < 60.0 ? u : 0.001 * u; };  // slowly to rest, never the same
  CHECK(frozen(swinging(rests), 0).longest == 0.0);
  const auto smooth = [](double t, double) { return t < 62.8 ? 0.1 * std::pow(std::sin(0.1 * t), 2) : 0.0; };
  CHECK(frozen(swinging(smooth), 0).longest == 0.0);  // made by a program, without noise
  // All at rest: a vehicle that lies still.
  Series still = swinging([](double, double u) { return u; });
  for (std::size_t i = still.size() / 2; i < still.size(); ++i) still.x[i] = still.x[still.size() / 2];
  CHECK(frozen(still, 0).longest == 0.0);
}

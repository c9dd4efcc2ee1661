// The computed response is what the filter as coded does to a sine.
#include "common/estimation/frequency_response.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "common/estimation/online/navigation_filter.hpp"

namespace fathom::estimation {
namespace {

/// Estimate over measurement by correlation with the sine over whole periods, when the start has died away.
std::complex<double> measured_response(const Gains& gains, double dt, int samples_per_period, bool velocity) {
  NavigationFilter filter{{.acceleration = 0.01, .bias_walk = 0.002, .bias_prior = 0.05}};
  filter.start(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Zero(), 0.1);
  AxisGains k;
  k.value.setConstant(gains.value);
  k.rate.setConstant(gains.rate);
  constexpr int kSettling = 4000, kPeriods = 5;  // samples; the slowest pole below takes 120 for a factor of e
  const int from = (kSettling / samples_per_period + 1) * samples_per_period;
  const int whole = kPeriods * samples_per_period;
  std::complex<double> sum{};
  for (int i = 0; i < from + whole; ++i) {
    const double phase = 2.0 * std::numbers::pi * (i % samples_per_period) / samples_per_period;
    const Eigen::Vector3d sine = std::sin(phase) * Eigen::Vector3d::UnitX();
    filter.predict(dt, Eigen::Matrix3d::Identity(), {0.0, 0.0, -9.81});
    const Eigen::Vector3d small = Eigen::Vector3d::Constant(1e-4);
    if (velocity) {
      filter.correct_velocity(sine - filter.velocity(), k, small, Eigen::Matrix3d::Identity());
    } else {
      filter.correct_position(sine - filter.position(), k, small, Eigen::Matrix3d::Identity());
    }
    const double estimate = velocity ? filter.velocity().x() : filter.position().x();
    if (i >= from) sum += estimate * std::polar(2.0 / whole, -phase);
  }
  return sum * std::complex<double>{0.0, 1.0};  // of exp(i phase), where the sine is -i times that
}

}  // namespace

TEST_CASE("frequency response: as computed, so the filter does, first and second order, computed and published gains") {
  struct Case {
    Gains gains;
    double dt;
    bool velocity;
  };
  for (const Case& one :
       {Case{first_order_gains(4.0, 1.0 / 30.0), 1.0 / 30.0, false}, Case{{.value = 0.09}, 1.0 / 30.0, false},
        Case{first_order_gains(0.05, 1.0), 1.0, false},
        Case{second_order_gains(4.0, 3.0, 1.0 / 30.0), 1.0 / 30.0, true},
        Case{{.value = 0.3, .rate = 0.2}, 1.0 / 30.0, true}, Case{second_order_gains(2.0, 1.0, 0.125), 0.125, true}}) {
    for (const int samples : {3, 8, 30, 200, 1000}) {
      CAPTURE(one.gains.value);
      CAPTURE(samples);
      const std::complex<double> computed = frequency_response(one.gains, one.dt, 1.0 / (one.dt * samples));
      // Both are exact sums of the same recursion; the start has died away to exp(-33), rounding is left.
      CHECK(std::abs(measured_response(one.gains, one.dt, samples, one.velocity) - computed) < 1e-10);
    }
  }
}

TEST_CASE("frequency response: all of a slow measurement passes, of a fast one little; half the power at the cut-off") {
  for (const double cutoff : {0.5, 4.0}) {
    const double dt = 1e-4;  // s: the sampled filter is the one of the paper's figure
    const double corner = cutoff / (2.0 * std::numbers::pi);
    const Gains first = first_order_gains(cutoff, dt), second = second_order_gains(cutoff, 1.0, dt);
    CHECK(std::norm(frequency_response(first, dt, corner)) == doctest::Approx(0.5).epsilon(1e-3));
    CHECK(std::abs(frequency_response(first, dt, 1e-3 * corner)) == doctest::Approx(1.0).epsilon(1e-4));
    CHECK(std::abs(frequency_response(second, dt, 1e-3 * corner)) == doctest::Approx(1.0).epsilon(1e-4));
    // (2 s w + w^2) / (s + w)^2 at s = i w: (1 + 2 i) / (2 i).
    CHECK(std::norm(frequency_response(second, dt, corner)) == doctest::Approx(1.25).epsilon(1e-3));
    CHECK(std::abs(frequency_response(second, dt, 100.0 * corner)) < 0.03);
  }
}

}  // namespace fathom::estimation

#include "common/estimation/smoothing_derivative.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace fathom::estimation {
namespace {

constexpr double kRounding = 1e-9;  // weights of 1/step, sums of some dozens

double slope_of(const SmoothingDerivative& filter, double step, const std::function<double(double)>& x) {
  double sum = 0.0;
  for (int k = -filter.half; k <= filter.half; ++k) {
    sum += filter.weight[static_cast<std::size_t>(k + filter.half)] * x(k * step);
  }
  return sum;
}

}  // namespace

TEST_CASE("smoothing derivative: the slope of a quartic is exact") {
  for (const double step : {0.005, 0.04, 0.1}) {
    const SmoothingDerivative filter = smoothing_derivative(step, 1.0, 0.03);
    REQUIRE(filter.weight.size() == static_cast<std::size_t>(2 * filter.half + 1));
    const auto quartic = [](double t) { return 2.0 + 3.0 * t - t * t + 4.0 * t * t * t + 5.0 * t * t * t * t; };
    CHECK(slope_of(filter, step, quartic) == doctest::Approx(3.0).epsilon(kRounding));
  }
}

TEST_CASE("smoothing derivative: the slope of a quartic is exact at unequal steps, and the same at equal ones") {
  const auto quartic = [](double t) { return 2.0 + 3.0 * t - t * t + 4.0 * t * t * t + 5.0 * t * t * t * t; };
  const std::vector<double> t{-0.2, -0.17, -0.13, -0.05, 0.0, 0.01, 0.09, 0.16};
  const std::vector<double> weight = slope_weights(t);
  double slope = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) slope += weight[i] * quartic(t[i]);
  CHECK(slope == doctest::Approx(3.0).epsilon(kRounding));
  const SmoothingDerivative filter = smoothing_derivative(0.04, 1.0, 0.03);
  std::vector<double> even;
  for (int k = -filter.half; k <= filter.half; ++k) even.push_back(0.04 * k);
  const std::vector<double> same = slope_weights(even);
  for (std::size_t i = 0; i < even.size(); ++i) CHECK(same[i] == doctest::Approx(filter.weight[i]).epsilon(1e-8));
}

TEST_CASE("smoothing derivative: the longest window that keeps the bandwidth, five samples at least") {
  constexpr double kBandwidth = 1.0, kTolerance = 0.03;
  const double omega = 2.0 * std::numbers::pi * kBandwidth;
  const SmoothingDerivative fast = smoothing_derivative(0.01, kBandwidth, kTolerance);
  CHECK(std::abs(fast.gain - 1.0) <= kTolerance);
  // The stated gain is that of a sine through zero.
  CHECK(slope_of(fast, 0.01, [&](double t) { return std::sin(omega * t) / omega; }) == doctest::Approx(fast.gain));
  const SmoothingDerivative wider = smoothing_derivative(0.01, 0.5 * kBandwidth, kTolerance);
  CHECK(wider.half > fast.half);
  CHECK(wider.noise < fast.noise);
  // Half the step: twice the samples under the same window.
  CHECK(std::abs(smoothing_derivative(0.005, kBandwidth, kTolerance).half - 2 * fast.half) <= 2);
  CHECK(smoothing_derivative(0.5, kBandwidth, kTolerance).half == 2);  // too slow for the bandwidth
}

TEST_CASE("smoothing derivative: the stated noise is the scatter of slopes of white noise") {
  constexpr double kStep = 0.04, kSigma = 0.01;
  constexpr int kDraws = 4000;
  constexpr double kScatter = 0.05;  // over four standard errors of a standard deviation from that many
  const SmoothingDerivative filter = smoothing_derivative(kStep, 1.0, 0.03);
  std::mt19937 random{1};
  std::normal_distribution<double> noise{0.0, kSigma};
  double squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    squares += std::pow(slope_of(filter, kStep, [&](double) { return noise(random); }), 2) / kDraws;
  }
  CHECK(std::sqrt(squares) == doctest::Approx(filter.noise * kSigma).epsilon(kScatter));
}

}  // namespace fathom::estimation

// The printing errors of Karras et al. in the gains of their filters, each as an example: the printed form fails on a
// known truth, and the gains that Fathom computes pass. Numbers are the paper's equations.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "common/estimation/online/complementary_filter.hpp"
#include "common/estimation/online/navigation_filter.hpp"

namespace fathom {
namespace {

/// Error of the depth that is left after a hundred rounds of one USBL fix and one depth of true value, 1 m at first.
double error_left(double k_usbl, double k_depth) {
  using Eigen::Vector3d;
  estimation::NavigationFilter filter{estimation::NavigationFilter::Noise{}};
  filter.start({0.0, 0.0, 1.0}, Vector3d::Constant(0.1), Vector3d::Zero(), 0.1);
  for (int k = 0; k < 100; ++k) {
    for (const double gain : {k_usbl, k_depth}) {
      const estimation::AxisGains gains{.value = {0.0, 0.0, gain}};
      filter.correct_position(-filter.position(), gains, Vector3d::Constant(0.01), Eigen::Matrix3d::Identity());
    }
  }
  return std::abs(filter.position().z());
}

}  // namespace

TEST_CASE("printed T_c: with 2 pi / w_c for a time constant the filter no longer passes half the power at w_c") {
  const double cutoff = 4.0, dt = 1e-4;
  const auto power_at_cutoff = [&](double k) {  // of x' = x + k (z - x): k z / (z - (1 - k))
    const std::complex<double> z = std::exp(std::complex<double>{0.0, cutoff * dt});
    return std::norm(k * z / (z - (1.0 - k)));
  };
  const double printed = dt / (dt + 2.0 * std::numbers::pi / cutoff);
  CHECK(power_at_cutoff(printed) == doctest::Approx(0.0247).epsilon(0.02));  // -16 dB
  CHECK(power_at_cutoff(estimation::first_order_gains(cutoff, dt).value) == doctest::Approx(0.5).epsilon(0.01));
}

TEST_CASE(
    "printed 1.30: K_b < dt w_c is no bound: the units differ, and the paper's own gains pass or fail by accident") {
  // Both poles of e' = (1 - k_p) e..., Jury: 0 < k_p < 2 and 0 < k_i < (4 - 2 k_p) / dt.
  const auto largest_pole = [](double k_p, double k_i, double dt) {
    const double trace = (1.0 - k_p) + (1.0 - k_i * dt), product = 1.0 - k_p;  // x^- = x - dt b, then both corrected
    const std::complex<double> root = std::sqrt(std::complex<double>{trace * trace - 4.0 * product, 0.0});
    return std::max(std::abs((trace + root) / 2.0), std::abs((trace - root) / 2.0));
  };
  const double dt = 1.0 / 60.0, cutoff = 4.0;
  CHECK(0.2 > dt * cutoff);                 // the published K_b breaks the printed bound...
  CHECK(0.2 < dt * cutoff * cutoff);        // ...and obeys the one with the right units,
  CHECK(largest_pole(0.3, 0.2, dt) < 1.0);  // and is stable as it should be
  for (const double step : {1e-3, 0.01, 0.1, 1.0}) {
    const auto k = estimation::second_order_gains(cutoff, 0.7, step);
    CHECK(k.rate < step * cutoff * cutoff);
    if (step < 1.0) CHECK(k.rate > step * cutoff);  // what the printed bound would forbid
    CHECK(k.rate < (4.0 - 2.0 * k.value) / step);
    CHECK(largest_pole(k.value, k.rate, step) < 1.0);
  }
}

TEST_CASE("printed 1.37: the bound on the depth's gain names the laser's, which deep water does not have") {
  // (1.34) corrects z by k_USBL and k_depth; (1.37) bounds k_USBL + k_l, copied from shallow water. With k_l = 0:
  const double k_usbl = 0.1, k_depth = 2.5;
  CHECK(k_usbl + 0.0 < 1.0);                  // obeyed...
  CHECK(error_left(k_usbl, k_depth) > 1e10);  // ...by what runs away;
  CHECK_FALSE(k_usbl + k_depth < 1.0);        // the bound on the gain that is meant refuses it,
  // Cut-offs of deep.yaml, at any interval: both sources together settle.
  for (const double dt : {0.01, 0.1, 1.0, 10.0}) {
    const double usbl = estimation::first_order_gains(0.05, dt).value;
    const double depth = estimation::first_order_gains(1.0, dt).value;
    CHECK(error_left(usbl, depth) < 0.5);
  }
  // The last line bounds the log's bias gain by dt w_c again: the paper's own (1.17) breaks it and is stable.
  for (const double dt : {0.01, 0.1}) {
    const double cutoff = 2.0, k_b = estimation::second_order_gains(cutoff, 1.0, dt).rate;
    CHECK(k_b > dt * cutoff);
    CHECK(k_b < dt * cutoff * cutoff);
  }
}

TEST_CASE("published gains follow from one interval of a sixtieth of a second, but for one that lost a digit") {
  const double dt = 1.0 / 60.0;
  const double two_pi = 2.0 * std::numbers::pi;
  // T_c as printed with the cut-off in Hz is 1 / f: 6 Hz, 4 Hz and 2 Hz.
  CHECK(estimation::first_order_gains(6.0, dt).value == doctest::Approx(0.09).epsilon(0.02));
  CHECK(estimation::first_order_gains(4.0, dt).value == doctest::Approx(0.05).epsilon(0.3));
  CHECK(estimation::first_order_gains(2.0, dt).value > 0.03);  // published: 0.003
  const auto across = estimation::second_order_gains(4.0, 3.0, dt);
  CHECK(across.value == doctest::Approx(0.3).epsilon(0.07));
  CHECK(across.rate == doctest::Approx(0.2).epsilon(0.1));
  CHECK(estimation::second_order_gains(4.0 * two_pi, 3.0, dt).value > 0.6);  // had they been Hz
}

}  // namespace fathom

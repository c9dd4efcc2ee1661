// The inside of a rollout's step: shares of a decaying slope against their power series, and one attitude's tilt with
// another's heading.
#include "common/model/rollout_steps.hpp"

#include <doctest/doctest.h>

#include <numbers>

#include "common/base/spatial.hpp"

using namespace fathom;
using namespace fathom::model;

namespace {

constexpr double kLeftOut = 1e-9;  // what the step's own series leave out
constexpr double kPi = std::numbers::pi;

struct Shares {
  long double whole{}, growth{}, whole_slope{}, growth_slope{};
};

/// Power series of (1 - e^-z) / z and (e^-z - 1 + z) / z^2, to the last digit for z below 2.
Shares by_series(long double z) {
  Shares sum;
  long double term = 1.0L;  // (-z)^n / n!
  for (int n = 0; n < 40; ++n) {
    sum.whole += term / static_cast<long double>(n + 1);
    sum.growth += term / static_cast<long double>((n + 1) * (n + 2));
    if (z > 0.0L) {
      sum.whole_slope += static_cast<long double>(n) * term / z / static_cast<long double>(n + 1);
      sum.growth_slope += static_cast<long double>(n) * term / z / static_cast<long double>((n + 1) * (n + 2));
    }
    term *= -z / static_cast<long double>(n + 1);
  }
  return sum;
}

Eigen::Quaterniond attitude(double roll, double pitch, double yaw) {
  return Eigen::Quaterniond{rotation_from_euler({roll, pitch, yaw})};
}

}  // namespace

TEST_CASE("rollout steps: shares of a decaying step and their slopes, on both sides of where series end") {
  for (const double z : {1e-9, 1e-4, 9.99e-3, 1.001e-2, 1.999e-2, 2.001e-2, 0.3, 1.5}) {
    CAPTURE(z);
    const StepShares shares{Vector6d::Constant(z), true};
    const Shares all = by_series(z), half = by_series(0.5L * z);
    CHECK(std::abs(shares.half[0] - static_cast<double>(half.whole)) < kLeftOut);
    CHECK(std::abs(shares.whole[0] - static_cast<double>(all.whole)) < kLeftOut);
    CHECK(std::abs(shares.growth[0] - static_cast<double>(all.growth)) < kLeftOut);
    CHECK(std::abs(shares.half_slope[0] - static_cast<double>(half.whole_slope)) < kLeftOut);
    CHECK(std::abs(shares.whole_slope[0] - static_cast<double>(all.whole_slope)) < kLeftOut);
    CHECK(std::abs(shares.growth_slope[0] - static_cast<double>(all.growth_slope)) < kLeftOut);
  }
  const StepShares still{Vector6d::Zero(), true};
  CHECK(still.whole == Vector6d::Ones());
  CHECK(still.growth == Vector6d::Constant(0.5));
  const StepShares stiff{Vector6d::Constant(1e4),
                         true};  // the step outlasts the decay: what remains is the steady answer
  CHECK(stiff.whole[0] == doctest::Approx(1e-4));
  CHECK(stiff.growth[0] == doctest::Approx(1e-4).epsilon(1e-3));
}

TEST_CASE("rollout steps: a tilt keeps its roll and pitch and takes the other's heading") {
  for (const double from : {0.0, 1.0, -3.1}) {
    for (const double turn : {0.0, 0.4, -1.7, 3.0, -3.0, kPi}) {
      const Eigen::Quaterniond mixed = with_heading(attitude(0.3, -0.4, from), attitude(-0.2, 0.5, from + turn));
      const Eigen::Vector3d euler = euler_from_rotation(mixed.toRotationMatrix());
      CHECK(euler.x() == doctest::Approx(0.3));
      CHECK(euler.y() == doctest::Approx(-0.4));
      CHECK(std::abs(wrap_angle(euler.z() - from - turn)) < 1e-7);  // half of the digits, where a cosine is near -1
      CHECK(std::abs(mixed.norm() - 1.0) < 1e-7);
    }
  }
}

TEST_CASE("rollout steps: what points straight up has no heading to take or to give") {
  const Eigen::Quaterniond up = attitude(0.0, 0.5 * kPi, 0.0), level = attitude(0.1, 0.2, 0.3);
  CHECK(with_heading(level, up).isApprox(level, 1e-6));
  CHECK(with_heading(up, level).coeffs().allFinite());
}

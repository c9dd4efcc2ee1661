// The filter's own arithmetic at a tilt; what it does with a trial's sensors is navigator_test.cpp's.
#include "common/estimation/navigation_filter.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace fathom::estimation {
namespace {

constexpr double kTilt = 0.6;  // rad, nose up

NavigationFilter started(double attitude) {
  NavigationFilter filter{{.acceleration = 0.01, .bias_walk = 0.002, .bias_prior = 0.05, .attitude = attitude}};
  filter.start(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(0.01), {0.3, -0.1, 0.2}, 0.1);
  return filter;
}

Eigen::Matrix3d pitched(double angle) { return Eigen::AngleAxisd{angle, Eigen::Vector3d::UnitY()}.toRotationMatrix(); }

}  // namespace

TEST_CASE("navigation filter: a horizontal velocity moves nothing vertical, whatever the tilt") {
  NavigationFilter filter = started(0.0);
  const auto before = filter.covariance();
  AxisGains gains;
  gains.value.setConstant(0.5);
  gains.rate.setConstant(0.2);
  filter.correct_horizontal_velocity({0.04, -0.02}, gains, Eigen::Vector2d::Constant(1e-4), pitched(kTilt));
  CHECK((filter.velocity() - Eigen::Vector3d{0.32, -0.11, 0.2}).norm() < 1e-12);
  // The bias is the sensor's, along the body: what was horizontal is partly along its z axis.
  CHECK((filter.bias() - Eigen::Vector3d{-0.008 * std::cos(kTilt), 0.004, -0.008 * std::sin(kTilt)}).norm() < 1e-12);
  CHECK(filter.covariance()[2].vv == before[2].vv);
  CHECK(filter.covariance()[0].vv == doctest::Approx(0.25 * 0.01 + 0.25 * 1e-4));  // (1 - k)^2 vv + k^2 r
  CHECK(filter.covariance()[1].vv == doctest::Approx(0.25 * 0.01 + 0.25 * 1e-4));
}

TEST_CASE(
    "navigation filter: where the attitude errs, a tilted vehicle's heave grows uncertain, a level one's does not") {
  const auto later = [](double attitude, double angle) {
    NavigationFilter filter = started(attitude);
    const Eigen::Matrix3d R_WB = pitched(angle);
    for (int i = 0; i < 100; ++i) filter.predict(0.01, R_WB, R_WB.transpose() * Eigen::Vector3d{0.0, 0.0, -9.81});
    return filter.covariance();
  };
  const double level = later(0.0, 0.0)[2].vv;
  CHECK(later(0.005, 0.0)[2].vv == doctest::Approx(level));
  const auto tilted = later(0.005, kTilt);
  // Twice the variance of the acceleration g sin(tilt) 5 mrad, for a second that lasts as long as the tilt does.
  CHECK(tilted[2].vv == doctest::Approx(level + 2.0 * std::pow(9.81 * std::sin(kTilt) * 0.005, 2)).epsilon(1e-6));
  CHECK(tilted[0].vv == doctest::Approx(later(0.0, kTilt)[0].vv));
}

}  // namespace fathom::estimation

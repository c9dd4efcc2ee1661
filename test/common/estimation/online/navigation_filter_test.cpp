// The filter's own arithmetic at a tilt; what it does with a trial's sensors is navigator_test.cpp's.
#include "common/estimation/online/navigation_filter.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/estimation/online/complementary_filter.hpp"

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
  // Nor later: what acceleration lacks across is a wrong attitude's, and no tilt turns it up.
  for (const double angle : {kTilt, 0.0, -kTilt}) {
    NavigationFilter later = filter;
    const Eigen::Matrix3d R_WB = pitched(angle);
    later.predict(1.0, R_WB, R_WB.transpose() * Eigen::Vector3d{0.0, 0.0, -9.81});
    CHECK(std::abs(later.velocity().z() - filter.velocity().z()) < 1e-12);
    if (angle == kTilt) CHECK((later.velocity() - Eigen::Vector3d{0.328, -0.114, 0.2}).norm() < 1e-12);
  }
  CHECK(filter.covariance()[2].vv == before[2].vv);
  CHECK(filter.covariance()[0].vv == doctest::Approx(0.25 * 0.01 + 0.25 * 1e-4));  // (1 - k)^2 vv + k^2 r
  CHECK(filter.covariance()[1].vv == doctest::Approx(0.25 * 0.01 + 0.25 * 1e-4));
}

TEST_CASE("navigation filter: at rest where gravity is another, nothing falls") {
  NavigationFilter filter{{.acceleration = 0.01, .bias_prior = 0.05, .gravity = 9.78}};
  filter.start(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Zero(), 0.1);
  for (int i = 0; i < 100; ++i)
    filter.predict(0.1, pitched(kTilt), pitched(kTilt).transpose() * Eigen::Vector3d{0.0, 0.0, -9.78});
  CHECK(filter.velocity().norm() < 1e-9);
}

// A vehicle that rocks on the spot, seen exactly at 30 Hz, with an attitude sensor whose level is off, or an
// accelerometer that is. Largest error of heave from 40 s on.
double heave_error(double off_level, double off_force) {
  NavigationFilter filter{{.acceleration = 0.01, .bias_walk = 0.002, .bias_prior = 0.05, .attitude = 0.005}};
  filter.start(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Zero(), 0.1);
  AxisGains k;
  const Gains one = third_order_gains(2.5, 1.0, 1.0 / 30.0);
  k.value.setConstant(one.value);
  k.rate.setConstant(one.rate);
  k.second.setConstant(one.second);
  double worst = 0.0;
  for (int i = 0; i < 60 * 30; ++i) {
    const Eigen::Matrix3d R_WB = pitched(0.4 * std::sin(2.0 * std::numbers::pi * 0.2 * i / 30.0));
    const Eigen::Vector3d f_B =
        R_WB.transpose() * Eigen::Vector3d{0.0, 0.0, -9.81} + off_force * Eigen::Vector3d::UnitX();
    const Eigen::Matrix3d told = R_WB * pitched(off_level);
    filter.predict(1.0 / 30.0, told, f_B);
    filter.correct_position(-filter.position(), k, Eigen::Vector3d::Constant(1e-4), told);
    if (i >= 40 * 30) worst = std::max(worst, std::abs(filter.velocity().z()));
  }
  return worst;
}

TEST_CASE("navigation filter: neither a level nor an accelerometer that is off makes heave of a vehicle that rocks") {
  // As a bias along the body, 9.81 times 10 mrad would be turned up by 0.4 rad to 4 cm/s^2, which the filter follows
  // for the inverse of its cut-off: 15 mm/s.
  CHECK(heave_error(0.01, 0.0) < 0.002);  // m/s
  CHECK(heave_error(0.0, 0.05) < 0.004);  // told apart while it rocks: 5 cm/s^2 are turned up as well, by itself 8 mm/s
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

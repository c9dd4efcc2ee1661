// The printing errors of Karras et al. in motion and camera, each as an example: on a motion that is known at every
// instant the printed form, typed here, fails, and what Fathom computes passes. Numbers are the paper's equations.
// Gains: printed_gains_test.cpp. Lever arms of velocity log, USBL and depth: test/common/driver.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "common/estimation/online/camera_geometry.hpp"
#include "common/estimation/online/navigation_filter.hpp"
#include "common/model/sensors/accelerometer.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d kGravity{0.0, 0.0, 9.81};  // m/s^2, g_N of the paper
constexpr double kStep = 1e-5;            // s
constexpr double kSmall = 1e-6;           // m, m/s, m/s^2: what differences over kStep leave of an exact equation
constexpr double kWrong = 0.02;           // what no trial could overlook
constexpr double kMoment = 7.3;           // s, when everything moves and tilts

test::SyntheticMotion motion() { return test::SyntheticMotion{3}; }

Vector3d rate_of_change(const auto& f, double t) { return (f(t + kStep) - f(t - kStep)) / (2.0 * kStep); }

estimation::CameraMount mount() {
  estimation::CameraMount m;
  m.p_BC = {0.2, 0.05, 0.1};
  m.R_BC << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  return m;
}

/// Velocity along W that Fathom's filter has at t + kStep, when it was right at t - kStep.
Vector3d predicted_velocity(const test::SyntheticMotion& m, double t) {
  estimation::NavigationFilter filter{{0.01, 0.001, 0.01}};
  filter.start(m.p_WB(t - kStep), Vector3d::Constant(0.01), m.R_WB(t - kStep) * m.v_B(t - kStep), 0.01);
  filter.predict(2.0 * kStep, m.R_WB(t), m.f_B(t));
  return filter.velocity();
}

/// What Fathom's model of an accelerometer says at rest, with the attitude in roll, pitch, yaw.
Vector3d felt_at_rest(const Vector3d& euler) {
  model::KinematicVector x = model::KinematicVector::Zero();
  x.segment<3>(model::at::kAngles) = euler;
  Vector3d felt;
  for (int i = 0; i < 3; ++i) {
    const model::Accelerometer along{.direction_B = Vector3d::Unit(i)};
    felt[i] = -model::observe(model::KinematicPoint{x}, along, 0.0, 1.0).innovation;
  }
  return felt;
}

}  // namespace

TEST_CASE("printed 1.19, 1.29: without w x v the velocity seen in the body does not follow from its acceleration") {
  const auto m = motion();
  const Matrix3d R = m.R_WB(kMoment);
  const Vector3d v_dot = rate_of_change([&](double t) { return m.v_B(t); }, kMoment);
  const Vector3d a = m.f_B(kMoment) + R.transpose() * kGravity;  // inertial acceleration seen in B
  CHECK((v_dot - a).norm() > kWrong);
  const Vector3d v_B = m.R_WB(kMoment + kStep).transpose() * predicted_velocity(m, kMoment);
  CHECK((v_dot - (v_B - m.v_B(kMoment - kStep)) / (2.0 * kStep)).norm() < kSmall);
}

TEST_CASE(
    "printed 1.21: at rest an accelerometer feels what holds it up, g against the world's down seen in the body") {
  // By hand: level; 30 deg to starboard, whose side then hangs lower; 30 deg bow up.
  const double g = model::kGravity, half = 0.5 * g, most = 0.5 * std::numbers::sqrt3 * g;
  const double angle = std::numbers::pi / 6.0;
  const std::array<std::array<Vector3d, 2>, 3> cases{{{Vector3d{0.0, 0.0, 1.0}, Vector3d{0.0, 0.0, -g}},
                                                      {Vector3d{angle, 0.0, 0.0}, Vector3d{0.0, -half, -most}},
                                                      {Vector3d{0.0, angle, 0.0}, Vector3d{half, 0.0, -most}}}};
  for (const auto& [euler, felt] : cases) {
    const Vector3d printed = rotation_from_euler(euler) * Vector3d{0.0, 0.0, g};
    CHECK((printed - felt).norm() > 1.0);
    CHECK((felt_at_rest(euler) - felt).norm() < kSmall);
  }
}

TEST_CASE("printed 1.29: gravity must be turned into the body before it is added, not out of it") {
  const auto m = motion();
  const Matrix3d R = m.R_WB(kMoment);
  const Vector3d a_W = rate_of_change([&](double t) { return Vector3d{m.R_WB(t) * m.v_B(t)}; }, kMoment);
  CHECK((R * (m.f_B(kMoment) + R * kGravity) - a_W).norm() > kWrong);
  const Vector3d before = m.R_WB(kMoment - kStep) * m.v_B(kMoment - kStep);
  CHECK(((predicted_velocity(m, kMoment) - before) / (2.0 * kStep) - a_W).norm() < kSmall);
}

TEST_CASE("printed 1.29: ten seconds of dead reckoning, printed and corrected") {
  const auto m = motion();
  const double dt = 0.01;
  estimation::NavigationFilter filter{{0.01, 0.001, 0.01}};
  filter.start(m.p_WB(0.0), Vector3d::Constant(0.01), m.R_WB(0.0) * m.v_B(0.0), 0.01);
  Vector3d printed = m.v_B(0.0);
  for (int k = 0; k < 1000; ++k) {
    const double t = (k + 0.5) * dt;
    filter.predict(dt, m.R_WB(t), m.f_B(t));
    printed += dt * (m.f_B(t) + m.R_WB(t) * kGravity);
  }
  CHECK((printed - m.v_B(10.0)).norm() > 1.0);  // m/s
  CHECK((m.R_WB(10.0).transpose() * filter.velocity() - m.v_B(10.0)).norm() < 0.002);
  CHECK((filter.position() - m.p_WB(10.0)).norm() < 0.005);
}

TEST_CASE("printed 1.26, 1.28: the camera's lever arm tilts with the vehicle and counts downwards") {
  // The paper's bottom is the plane z = 0.
  const auto m = motion();
  const auto c = mount();
  const Matrix3d R = m.R_WB(kMoment);
  const Vector3d p = m.p_WB(kMoment) - Vector3d{0.0, 0.0, 2.0};
  const Vector3d lens = p + R * c.p_BC;
  const double distance = -lens.z() / (R * c.R_BC)(2, 2);  // along the optical axis until z = 0
  const double printed_distance = -(p.z() + c.p_BC.z()) / R(2, 2);
  CHECK(std::abs(printed_distance - distance) > 0.001);
  CHECK(std::abs(estimation::distance_to_floor(0.0, p, c, R) - distance) < kSmall);
  const double printed_z = -(R(2, 2) * distance - c.p_BC.z());
  CHECK(std::abs(printed_z - p.z()) > kWrong);
  CHECK(std::abs(estimation::depth_from_floor_point(0.0, {0.0, 0.0, distance}, c, R) - p.z()) < kSmall);
}

TEST_CASE("1.24, 1.28: a tag's place in the camera gives the body's place in the world") {
  const auto m = motion();
  const auto c = mount();
  const Matrix3d R = m.R_WB(kMoment);
  const Vector3d p = m.p_WB(kMoment), tag{0.3, -0.2, 1.5};
  const Vector3d p_CT = c.R_BC.transpose() * (R.transpose() * (tag - p) - c.p_BC);
  CHECK((estimation::position_from_tag(tag, p_CT, c, R) - p).norm() < kSmall);
}

TEST_CASE("1.25: the scene moves opposite to the camera; with the camera's own sign the velocity is mirrored") {
  const auto m = motion();
  const auto c = mount();
  const double floor = 3.0;
  // A point of the floor, followed in the camera over a moment; the camera's rotation is removed by holding its
  // attitude.
  const Matrix3d R = m.R_WB(kMoment);
  const Matrix3d R_WC = R * c.R_BC;
  const auto lens = [&](double t) { return Vector3d{m.p_WB(t) + m.R_WB(t) * c.p_BC}; };
  const double distance = estimation::distance_to_floor(floor, m.p_WB(kMoment), c, R);
  const Vector3d point = lens(kMoment) + R_WC.col(2) * distance;
  const auto image = [&](double t) {
    const Vector3d p = R_WC.transpose() * (point - lens(t));
    return Vector3d{p.x() / p.z(), p.y() / p.z(), std::log(p.z())};  // the picture grows as the distance falls
  };
  const Vector3d flow = rate_of_change(image, kMoment);
  const Vector3d v_C = estimation::velocity_of_camera(m.v_B(kMoment), m.w_B(kMoment), c);
  CHECK((distance * flow.head<2>() - v_C.head<2>()).norm() > kWrong);  // "printed": flow taken for the camera's motion
  CHECK((estimation::velocity_from_flow(flow, distance) - v_C).norm() < kSmall);
}

}  // namespace fathom

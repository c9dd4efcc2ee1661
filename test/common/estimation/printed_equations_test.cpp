// The printing errors of Karras et al. that concern the estimator, each as an example: on a motion that is known at
// every instant the printed form fails and the corrected one passes. Numbers are the paper's equations.
#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "common/estimation/camera_geometry.hpp"
#include "common/estimation/complementary_filter.hpp"
#include "common/estimation/navigation_filter.hpp"
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

}  // namespace

TEST_CASE("printed 1.19, 1.29: without w x v the velocity seen in the body does not follow from its acceleration") {
  const auto m = motion();
  const Vector3d v = m.v_B(kMoment), w = m.w_B(kMoment);
  const Matrix3d R = m.R_WB(kMoment);
  const Vector3d v_dot = rate_of_change([&](double t) { return m.v_B(t); }, kMoment);
  const Vector3d a = m.f_B(kMoment) + R.transpose() * kGravity;  // inertial acceleration seen in B
  CHECK((v_dot - a).norm() > kWrong);
  CHECK((v_dot - (a - w.cross(v))).norm() < kSmall);
}

TEST_CASE("printed 1.21: at rest and level an accelerometer feels -g along z down, and a tilted one R'g") {
  for (const double roll : {0.0, 0.3}) {
    const Matrix3d R = rotation_from_euler({roll, 0.2, 1.0});
    const Vector3d felt = R.transpose() * (Vector3d::Zero() - kGravity);  // specific force: acceleration less gravity
    const Vector3d printed = R * kGravity;
    const Vector3d corrected = -R.transpose() * kGravity;
    CHECK((printed - felt).norm() > 1.0);
    CHECK((corrected - felt).norm() < kSmall);
  }
}

TEST_CASE("printed 1.29: gravity must be turned into the body before it is added, not out of it") {
  const auto m = motion();
  const Matrix3d R = m.R_WB(kMoment);
  const Vector3d a_W = rate_of_change([&](double t) { return Vector3d{m.R_WB(t) * m.v_B(t)}; }, kMoment);
  const Vector3d truth = R.transpose() * a_W;
  CHECK((m.f_B(kMoment) + R * kGravity - truth).norm() > kWrong);
  CHECK((m.f_B(kMoment) + R.transpose() * kGravity - truth).norm() < kSmall);
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
    return Vector3d{p.x() / p.z(), p.y() / p.z(), 0.0};
  };
  const Vector3d flow = rate_of_change(image, kMoment);
  const Vector3d v_C = estimation::velocity_of_camera(m.v_B(kMoment), m.w_B(kMoment), c);
  CHECK((distance * flow.head<2>() - v_C.head<2>()).norm() > kWrong);  // "printed": flow taken for the camera's motion
  CHECK((estimation::velocity_from_flow(flow.head<2>(), distance) - v_C.head<2>()).norm() < kSmall);
}

TEST_CASE("printed 1.35: a velocity log's lever arm is turned by the rates, not taken from the velocity") {
  const auto m = motion();
  const Vector3d lever{0.3, 0.0, 0.1};
  const Vector3d v = m.v_B(kMoment), w = m.w_B(kMoment);
  const Vector3d place = rate_of_change([&](double t) { return Vector3d{m.p_WB(t) + m.R_WB(t) * lever}; }, kMoment);
  const Vector3d measured = m.R_WB(kMoment).transpose() * place;
  CHECK((measured - lever - v).norm() > kWrong);
  CHECK((measured - w.cross(lever) - v).norm() < kSmall);
}

TEST_CASE("printed 1.33, 1.35: a pressure port tells its depth whatever the tilt, positive down") {
  const auto m = motion();
  const Vector3d lever{-0.2, 0.1, 0.15};
  const Matrix3d R = m.R_WB(kMoment);
  const Vector3d p = m.p_WB(kMoment) + Vector3d{0.0, 0.0, 2.0};
  const double pressure = (p + R * lever).z();         // metres of water above the port
  CHECK(std::abs(-R(2, 2) * pressure - p.z()) > 1.0);  // the printed aiding drives z to -z
  CHECK(std::abs(pressure - R.row(2).dot(lever) - p.z()) < kSmall);
}

TEST_CASE("printed 1.32: the world is turned into the vehicle by the transpose") {
  const auto m = motion();
  const Matrix3d R = m.R_WB(kMoment);
  const Vector3d lever{0.1, 0.0, -0.2};
  const Vector3d p = m.p_WB(kMoment) + Vector3d{10.0, -5.0, 3.0};
  const Vector3d seen = R.transpose() * (p + R * lever);  // responder from the transceiver, in responder axes
  CHECK((R * p + lever - seen).norm() > 1.0);
  CHECK((R.transpose() * p + lever - seen).norm() < kSmall);
  CHECK((R * (seen - lever) - p).norm() < kSmall);  // (1.35)
}

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
    CHECK(k.rate < (4.0 - 2.0 * k.value) / step);
    CHECK(largest_pole(k.value, k.rate, step) < 1.0);
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

// Gains against their defining equations, covariances against a simulated ensemble.
#include "common/estimation/online/complementary_filter.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <utility>

#include "common/base/spatial.hpp"

namespace fathom {
namespace {

constexpr double kRounding = 1e-12;

}  // namespace

TEST_CASE("complementary gains: a hundred steps of the filter are the backward-Euler solution of its equations") {
  // x' = u - b + 2 zeta w (z - x), b' = -w^2 (z - x), solved implicitly by hand for one step.
  const double w = 3.0, zeta = 0.7, dt = 0.05;
  double x = 0.2, b = -0.1, xi = x, bi = b;
  for (int i = 0; i < 100; ++i) {
    const double u = std::sin(0.3 * i), z = std::cos(0.1 * i);
    const auto gains = estimation::second_order_gains(w, zeta, dt);
    const double error = z - (x + dt * (u - b));
    x += dt * (u - b) + gains.value * error;
    b -= gains.rate * error;
    // Implicit: unknown e = z - xi_new; xi_new = xi + dt (u - bi_new + 2 zeta w e), bi_new = bi - dt w^2 e.
    const double e = (z - xi - dt * (u - bi)) / (1.0 + dt * 2.0 * zeta * w + dt * dt * w * w);
    bi -= dt * w * w * e;
    xi = z - e;
    CHECK(x == doctest::Approx(xi).epsilon(kRounding));
    CHECK(b == doctest::Approx(bi).epsilon(kRounding));
  }
}

TEST_CASE(
    "complementary gains: they obey the stability bounds for every interval, and the third order begins as the "
    "second") {
  for (const double dt : {1e-4, 0.01, 0.1, 1.0, 30.0}) {
    const auto first = estimation::first_order_gains(2.0, dt);
    CHECK(first.value == doctest::Approx(dt / (dt + 0.5)).epsilon(kRounding));
    const auto second = estimation::second_order_gains(2.0, 0.7, dt);
    CHECK(second.value < 1.0);
    CHECK(second.rate < dt * 4.0);  // K_b < dt w^2
    const auto third = estimation::third_order_gains(2.0, 0.7, dt);
    CHECK(third.value < 1.0);
    CHECK(third.value > second.value);
  }
}

TEST_CASE("complementary gains: two sources that disagree make no false speed, although one of them skips samples") {
  // At rest; one source says 0, the other a centimetre, and every other sample of it is lost for half of the time.
  const double w = 2.5, dt = 1.0 / 30.0, apart = 0.01;
  const auto mean_speed = [&](auto gains) {
    double p = 0.0, v = 0.0, a = 0.0, sum = 0.0;
    int n = 0, last = -1;
    for (int k = 0; k < 30'000; ++k) {
      p += dt * v + 0.5 * dt * dt * a;
      v += dt * a;
      const auto correct = [&](double z, double interval) {
        const auto g = gains(w, 1.0, interval);
        const double error = z - p;
        p += g.value * error;
        v += g.rate * error;
        a += g.second * error;
      };
      correct(0.0, dt);
      if (k % 60 < 30 || k % 2 == 0) correct(apart, dt * (k - std::exchange(last, k)));
      if (k < 3000) continue;
      sum += v;
      ++n;
    }
    return sum / n;
  };
  CHECK(std::abs(mean_speed(estimation::third_order_gains)) > 1e-4);  // m/s: 2 mN of weight by a drag of 20 N/(m/s)
  CHECK(std::abs(mean_speed(estimation::proportional_third_order_gains)) < 1e-6);
}

TEST_CASE("complementary gains: in proportion they are stable at every interval and damping, and else as designed") {
  for (const double damping : {0.5, 1.0, 3.0}) {
    for (const double dt : {1e-3, 0.01, 0.1, 0.3, 0.7, 1.0, 1.9, 2.1, 5.0, 30.0}) {
      CAPTURE(damping);
      CAPTURE(dt);
      const auto g = estimation::proportional_third_order_gains(1.0, damping, dt);
      double p = 1.0, v = 0.3, a = -0.2;
      for (int k = 0; k < 100 + static_cast<int>(100.0 / dt); ++k) {
        p += dt * v + 0.5 * dt * dt * a;
        v += dt * a;
        const double error = -p;
        p += g.value * error;
        v += g.rate * error;
        a += g.second * error;
      }
      CHECK(std::abs(p) + std::abs(v) + std::abs(a) < 1e-3);
    }
    const auto fine = estimation::proportional_third_order_gains(3.0, damping, 1e-4);
    const auto designed = estimation::third_order_gains(3.0, damping, 1e-4);
    CHECK(fine.value == doctest::Approx(designed.value).epsilon(1e-3));
    CHECK(fine.rate == doctest::Approx(designed.rate).epsilon(1e-3));
    CHECK(fine.second == doctest::Approx(designed.second).epsilon(1e-3));
  }
}

TEST_CASE("pair covariance: it is that of ten thousand simulated filters") {
  constexpr int kFilters = 10'000;
  constexpr double kBand = 0.05;  // three standard errors of a variance from 10,000 samples are 4 %
  const double dt = 0.1, noise = 0.02, walk = 0.05;
  const auto gains = estimation::second_order_gains(4.0, 0.8, dt);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  double xx = 0.0, xr = 0.0, rr = 0.0;
  for (int i = 0; i < kFilters; ++i) {
    double x = 0.0, v = 0.0, x_hat = noise * normal(random), v_hat = normal(random);
    for (int k = 0; k < 30; ++k) {
      x += dt * v;
      v += walk * std::sqrt(dt) * normal(random);
      x_hat += dt * v_hat;
      const double error = x + noise * normal(random) - x_hat;
      x_hat += gains.value * error;
      v_hat += gains.rate * error;
    }
    xx += (x - x_hat) * (x - x_hat) / kFilters;
    xr += (x - x_hat) * (v - v_hat) / kFilters;
    rr += (v - v_hat) * (v - v_hat) / kFilters;
  }
  estimation::PairCovariance covariance{noise * noise, 0.0, 1.0};
  for (int k = 0; k < 30; ++k) {
    covariance.predict(1.0, dt, 0.0, 0.0, walk * walk * dt);
    covariance.correct_value(gains.value, gains.rate, noise * noise);
  }
  CHECK(covariance.xx == doctest::Approx(xx).epsilon(kBand));
  CHECK(covariance.xr == doctest::Approx(xr).epsilon(kBand));
  CHECK(covariance.rr == doctest::Approx(rr).epsilon(kBand));
}

TEST_CASE("attitude filter: a constant gyro bias is found and taken out") {
  constexpr double kTolerance = 1e-4;  // rad/s, after ten time constants
  const Eigen::Vector3d bias{0.02, -0.01, 0.03}, w{0.1, 0.2, -0.3};
  estimation::AttitudeFilter filter(1.0, 0.8, {.rate = 0.01, .bias_walk = 1e-4, .rate_walk = 0.1, .bias_prior = 0.05});
  filter.start(Eigen::Quaterniond::Identity(), 0.01);
  filter.set_gyro(w + bias);
  for (int k = 1; k <= 400; ++k) {
    filter.predict(0.05);
    filter.correct(filter.innovation(quaternion_from_rotation_vector(w * (0.05 * k))), 0.05, 0.01);
  }
  CHECK((filter.bias() - bias).norm() < kTolerance);
  CHECK((filter.rates() - w).norm() < kTolerance);
}

TEST_CASE("translation filter: a wrong accelerometer tilts nothing in the long run") {
  constexpr double kTolerance = 1e-4;  // m/s, m after the third integrator has settled
  estimation::TranslationFilter filter(2.0, 0.8, 1.0, {.acceleration = 0.05, .velocity_prior = 1.0});
  const Eigen::Vector3d sigma = Eigen::Vector3d::Constant(0.01);
  filter.start(Eigen::Vector3d::Zero(), sigma);
  const Eigen::Matrix3d R = rotation_from_euler({0.1, -0.2, 0.7});
  const Eigen::Vector3d still = R.transpose() * Eigen::Vector3d(0.0, 0.0, -9.81), bias{0.2, -0.1, 0.3};
  for (int k = 0; k < 600; ++k) {
    filter.predict(0.05, R, still + bias);
    filter.correct_position(-filter.position(), Eigen::Vector3d::Ones(), 0.05, 0.01, R);
  }
  CHECK(filter.position().norm() < kTolerance);
  CHECK(filter.velocity().norm() < 10.0 * kTolerance);
}

}  // namespace fathom

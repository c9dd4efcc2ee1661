// Attitude averaged along the rates: less noise in any motion, nothing lost where there is none, gaps respected.
#include "common/estimation/steady_attitude.hpp"

#include <doctest/doctest.h>

#include <random>

using namespace fathom;

namespace {

constexpr double kDt = 0.02;  // s

struct Noise {
  double attitude{}, rates{}, scale{0.0};  // rad, rad/s, of the rates
};

struct Turning {
  Trial trial;
  std::vector<Eigen::Quaterniond> truth;
};

/// Rolls, pitches and turns at up to half a radian per second.
Turning turning(const Noise& noise, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  const auto three = [&](double sigma) {
    return Eigen::Vector3d{sigma * normal(random), sigma * normal(random), sigma * normal(random)};
  };
  Turning made;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Trial& trial = made.trial;
  trial.dt = kDt;
  trial.observed = {.attitude = true, .rates = true};
  const auto rates = [](double t) {
    return Eigen::Vector3d{0.3 * std::sin(1.1 * t), 0.2 * std::cos(0.7 * t), 0.5 * std::sin(0.4 * t)};
  };
  for (int k = 0; k < 3000; ++k) {
    const double t = kDt * k;
    made.truth.push_back(q);
    trial.t.push_back(t);
    trial.q_WB.push_back(q * quaternion_from_rotation_vector(three(noise.attitude)));
    trial.nu.push_back((Vector6d() << 0, 0, 0, (1.0 + noise.scale) * rates(t) + three(noise.rates)).finished());
    trial.pose_valid.push_back(1);
    trial.rates_valid.push_back(1);
    for (int s = 0; s < 10; ++s) q = q * quaternion_from_rotation_vector(0.1 * kDt * rates(t + (0.1 * s + 0.05) * kDt));
  }
  trial.nu_sigma.tail<3>().setConstant(noise.rates);
  return made;
}

double error(const Turning& made, std::size_t from = 100, std::size_t to = 2900) {
  double square = 0.0;
  for (std::size_t k = from; k < to; ++k)
    square += rotation_vector_from_quaternion(made.truth[k].conjugate() * made.trial.q_WB[k]).squaredNorm() / 3.0;
  return std::sqrt(square / static_cast<double>(to - from));
}

}  // namespace

TEST_CASE("steady attitude: noise falls as the mean of half a second to each side lets it, in any motion") {
  Turning made = turning({.attitude = 3.5e-3, .rates = 3.5e-3}, 1);
  REQUIRE(error(made) == doctest::Approx(3.5e-3).epsilon(0.05));
  estimation::steady_attitude(made.trial);
  // 51 attitudes, and a walk of 25 steps to each side.
  const double expected = std::sqrt(3.5e-3 * 3.5e-3 / 51.0 + 25.0 / 6.0 * std::pow(3.5e-3 * kDt, 2));
  CHECK(error(made) == doctest::Approx(expected).epsilon(0.15));
}

TEST_CASE("steady attitude: a scale error of the rates does little harm, and noisy rates none") {
  Turning scaled = turning({.attitude = 3.5e-3, .rates = 3.5e-3, .scale = 0.02}, 2);
  estimation::steady_attitude(scaled.trial);
  CHECK(error(scaled) < 0.3 * 3.5e-3);
  Turning rough = turning({.attitude = 1e-3, .rates = 0.3}, 3);
  estimation::steady_attitude(rough.trial);
  CHECK(error(rough) < 1.05e-3);
}

TEST_CASE("steady attitude: without noise nothing changes, and a mean never reaches across a gap") {
  Turning clean = turning({}, 4);
  estimation::steady_attitude(clean.trial);
  CHECK(error(clean) < 1e-4);  // the rates' straight lines

  Turning gap = turning({.attitude = 3.5e-3, .rates = 3.5e-3}, 5);
  for (std::size_t k = 1000; k < 1100; ++k) {
    gap.trial.pose_valid[k] = 0;
    gap.trial.q_WB[k] = Eigen::Quaterniond{0.0, 1.0, 0.0, 0.0};
  }
  estimation::steady_attitude(gap.trial);
  CHECK(error(gap, 900, 1000) < 2.5e-3);
  CHECK(error(gap, 1100, 1200) < 2.5e-3);
  CHECK(gap.trial.q_WB[1050].w() == doctest::Approx(0.0));
}

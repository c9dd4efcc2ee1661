// Gyros whose axes stand turned against the attitude told beside them.
#include "common/estimation/smoothing/turned_package.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "common/base/spatial.hpp"

namespace fathom::estimation {
namespace {

constexpr double kRate = 100.0;  // Hz
const Eigen::Vector3d kTurn{8e-3, -6e-3, 4e-3}, kBias{2e-4, -1e-4, 3e-4};

struct Told {
  double yaw_rate{0.3}, tilt_rate{0.1};                // rad/s, amplitudes
  double white{1e-3}, wander{5e-3}, gyro_noise{3e-3};  // rad, rad, rad/s
  bool leaps{false};
};

std::vector<Ahrs> stream(const Told& o, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  const auto three = [&](double sigma) {
    return Eigen::Vector3d{sigma * normal(random), sigma * normal(random), sigma * normal(random)};
  };
  const Eigen::Matrix3d R_BI = quaternion_from_rotation_vector(kTurn).toRotationMatrix();
  std::vector<Ahrs> all;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d wander = Eigen::Vector3d::Zero();
  for (int k = 0; k < 300 * static_cast<int>(kRate); ++k) {
    const double t = k / kRate;
    const Eigen::Vector3d w{o.tilt_rate * std::sin(0.9 * t), o.tilt_rate * std::cos(0.7 * t),
                            o.yaw_rate * std::sin(0.2 * t)};
    const double decay = std::exp(-1.0 / (kRate * 60.0));
    wander = decay * wander + three(o.wander * std::sqrt(1.0 - decay * decay));
    Eigen::Quaterniond told = q * quaternion_from_rotation_vector(wander + three(o.white));
    if (o.leaps && k % 3000 == 1500) told = told * quaternion_from_rotation_vector({0.0, 0.0, 0.5});
    all.push_back({.utime = static_cast<Utime>(1e6 * t),
                   .w_WB_B = R_BI.transpose() * w + kBias + three(o.gyro_noise),
                   .q_WB = told,
                   .has_rates = true,
                   .has_attitude = true});
    const Eigen::Vector3d next{o.tilt_rate * std::sin(0.9 * (t + 0.01)), o.tilt_rate * std::cos(0.7 * (t + 0.01)),
                               o.yaw_rate * std::sin(0.2 * (t + 0.01))};
    q = (q * quaternion_from_rotation_vector(0.5 / kRate * (w + next))).normalized();
  }
  return all;
}

}  // namespace

TEST_CASE("turned package: found within what it says, over seeds, attitudes that leap or not") {
  double square = 0.0;
  constexpr int kSeeds = 10;
  for (unsigned seed = 0; seed < 2 * kSeeds; ++seed) {
    const auto found = turned_package(stream({.leaps = seed >= kSeeds}, seed));
    REQUIRE(found);
    CHECK(found->sigma < 2e-3);
    // The attitude's error of 5 mrad, which lasts for a minute, is a turn as well, as long as it lasts.
    const double variance = found->sigma * found->sigma + 5e-3 * 5e-3 * 2.0 * 60.0 / 300.0;
    square += (found->turn - kTurn).squaredNorm() / (3.0 * variance * 2.0 * kSeeds);
  }
  CHECK(square < 1.5);  // sigma is that of the least certain component
  CHECK(square > 0.05);
}

TEST_CASE("turned package: too little turning tells nothing, nor does a package without rates") {
  const auto still = turned_package(stream({.yaw_rate = 0.0, .tilt_rate = 0.0}, 1));
  CHECK_FALSE(still);
  std::vector<Ahrs> silent = stream({}, 1);
  for (Ahrs& one : silent) one.has_rates = false;
  CHECK_FALSE(turned_package(silent));
  CHECK_FALSE(turned_package({}));
}

}  // namespace fathom::estimation

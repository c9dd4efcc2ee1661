// One axis that is far noisier than the others is named; noise that all axes share is the sensor's own.
#include <doctest/doctest.h>

#include <random>

#include "test/support/consistency.hpp"

namespace fathom {
namespace {

using test::find;

std::vector<ConsistencyFinding> noise_with(const Eigen::Vector3d& gyro, const Eigen::Vector3d& dvl) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto noise = [&](const Eigen::Vector3d& sigma) {
    return Eigen::Vector3d(sigma.x() * normal(random), sigma.y() * normal(random), sigma.z() * normal(random));
  };
  const Recording recording =
      test::synthetic_recording({.seed = 18,
                                 .duration = 60.0,
                                 .spoil_dvl = [&](Dvl& sample, double) { sample.v_WB_B += noise(dvl); },
                                 .spoil_gyro = [&](Ahrs& sample, double) { sample.w_WB_B += noise(gyro); }});
  std::vector<ConsistencyFinding> ignored;
  const estimation::RunSignals run = estimation::read_signals(recording, ignored);
  return consistency::compare_noise(std::span(&run, 1));
}

}  // namespace

TEST_CASE("noise comparison: the odd axis is named with its noise") {
  const auto dvl = noise_with({0, 0, 0}, {0, 0, 0.1});
  REQUIRE(find(dvl, "dvl.w", "noise") != nullptr);
  CHECK(find(dvl, "dvl.w", "noise")->size == doctest::Approx(0.1).epsilon(0.15));
  CHECK(dvl.size() == 1);
  const auto gyro = noise_with({0, 0.05, 0}, {0, 0, 0});
  REQUIRE(find(gyro, "gyro.q", "noise") != nullptr);
  CHECK(gyro.size() == 1);
}

TEST_CASE("noise comparison: equal noise, and noise too small to matter, are nobody's fault") {
  CHECK(noise_with({0, 0, 0}, {0, 0, 0}).empty());
  CHECK(noise_with({0.05, 0.05, 0.05}, {0.1, 0.1, 0.1}).empty());
  CHECK(noise_with({0, 0, 0}, {0, 0.01, 0}).empty());  // twice the others'
}

}  // namespace fathom

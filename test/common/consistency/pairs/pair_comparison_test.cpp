// Every fault of gyro and DVL that is put in is found, named and measured, and the motion comes out right.
#include "common/consistency/pairs/pair_comparison.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>

#include "common/base/statistics.hpp"
#include "test/support/consistency.hpp"

namespace fathom {

using test::check;
using test::check_motion;
using test::find;
using test::print;
using test::SyntheticOptions;

TEST_CASE("delays are found within their interval") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  constexpr double kTolerance = 0.008;  // s: four sigmas of the worst seed
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const double gyro = any(random), dvl = any(random);
    const auto checked = check({.seed = seed, .gyro_delay = gyro, .dvl_delay = dvl});
    const auto& findings = checked.findings();
    INFO("gyro ", gyro, " dvl ", dvl);
    const ConsistencyFinding* one = find(findings, "gyro", "delay");
    const ConsistencyFinding* two = find(findings, "dvl", "delay");
    REQUIRE(one != nullptr);
    REQUIRE(two != nullptr);
    CHECK(std::abs(one->size - gyro) < kTolerance);
    CHECK(std::abs(two->size - dvl) < kTolerance);
    CHECK(findings.size() == 3);  // and the clock
    if (findings.size() != 3) print(findings);
    check_motion(checked);
  }
}

TEST_CASE("stated errors cover the truth") {
  int delays = 0, biases = 0;
  double ratios = 0.0;
  constexpr unsigned kSeeds = 24;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const double delay = 0.01 * seed - 0.1;
    const Recording recording =
        test::synthetic_recording({.seed = seed, .dvl_rate = 0.0, .gyro_bias = {0.01, 0.0, 0.0}, .gyro_delay = delay});
    const auto result = consistency::check_consistency(std::span(&recording, 1));
    const consistency::IncrementFit& fit = result.pairs.at("gyro").fits[0];
    const double off = std::abs(fit.delay - delay) / jackknife_sigma(fit.delay_replicates);
    ratios += off * off / kSeeds;
    delays += off < 2.2;  // 95 % of Student's law with 7 degrees of freedom is 2.4
    std::vector<double> bias;
    for (const Eigen::VectorXd& theta : fit.theta_replicates) bias.push_back(theta[9]);
    biases += std::abs(fit.theta[9] + 0.01) < 2.2 * jackknife_sigma(bias);
  }
  std::printf("coverage of 2.2 sigma: delay %d, bias %d of %u; mean square ratio %.2f\n", delays, biases, kSeeds,
              ratios);
  constexpr int kFewest = 19;  // of 24: chance of fewer is under 1 % when 95 % are covered
  CHECK(delays >= kFewest);
  CHECK(biases >= kFewest);
}

TEST_CASE("signs and swapped axes are found and undone") {
  SUBCASE("one sign of the gyro") {
    const SyntheticOptions options{.seed = 3, .gyro_matrix = Eigen::Vector3d(1, -1, 1).asDiagonal()};
    const auto checked = check(options);
    const auto& findings = checked.findings();
    CHECK(find(findings, "gyro.q", "sign") != nullptr);
    CHECK(findings.size() == 1);
    print(findings);
    check_motion(checked);
  }
  SUBCASE("gyro axes swapped") {
    Eigen::Matrix3d swap;
    swap << 0, 1, 0, 1, 0, 0, 0, 0, 1;
    const SyntheticOptions options{.seed = 4, .gyro_matrix = swap};
    const auto checked = check(options);
    const auto& findings = checked.findings();
    CHECK(find(findings, "gyro.p", "axes") != nullptr);
    CHECK(find(findings, "gyro.q", "axes") != nullptr);
    print(findings);
    check_motion(checked);
  }
  SUBCASE("DVL in forward-left-up axes") {
    const SyntheticOptions options{.seed = 5, .dvl_matrix = Eigen::Vector3d(1, -1, -1).asDiagonal()};
    const auto checked = check(options);
    const auto& findings = checked.findings();
    CHECK(find(findings, "dvl.v", "sign") != nullptr);
    CHECK(find(findings, "dvl.w", "sign") != nullptr);
    CHECK(findings.size() == 2);
    print(findings);
    check_motion(checked);
  }
  SUBCASE("accelerometer upside down in sign") {
    const SyntheticOptions options{.seed = 6, .accelerometer = true, .force_matrix = -Eigen::Matrix3d::Identity()};
    const auto checked = check(options);
    const auto& findings = checked.findings();
    CHECK(find(findings, "accelerometer.z", "sign") != nullptr);
    print(findings);
  }
}

TEST_CASE("units and scales are found, and which signal is to blame") {
  SUBCASE("gyro in degrees") {
    const SyntheticOptions options{.seed = 7, .gyro_matrix = 57.29578 * Eigen::Matrix3d::Identity()};
    const auto checked = check(options);
    const auto& findings = checked.findings();
    print(findings);
    for (const char* axis : {"gyro.p", "gyro.q", "gyro.r"}) CHECK(find(findings, axis, "unit") != nullptr);
    check_motion(checked);
  }
  SUBCASE("position in millimetres, centimetres, feet") {
    for (const double factor : {1000.0, 100.0, 3.28084}) {
      const SyntheticOptions options{.seed = 8, .spoil_pose = [factor](PoseCapture& pose) { pose.p_WB *= factor; }};
      const auto checked = check(options);
      const auto& findings = checked.findings();
      print(findings);
      REQUIRE(find(findings, "pose_capture.position", "unit") != nullptr);
      CHECK(find(findings, "pose_capture.position", "unit")->size == doctest::Approx(factor));
      CHECK(findings.size() == 1);
      check_motion(checked);
    }
  }
  SUBCASE("DVL a few per cent high, coverage over seeds") {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const double scale = 1.0 + 0.02 * seed;
      const SyntheticOptions options{.seed = seed, .dvl_matrix = scale * Eigen::Matrix3d::Identity()};
      const auto checked = check(options);
      const auto& findings = checked.findings();
      print(findings);
      for (const char* axis : {"dvl.u", "dvl.v", "dvl.w"}) {
        const ConsistencyFinding* one = find(findings, axis, "scale");
        REQUIRE(one != nullptr);
        CHECK(std::abs(one->size * scale - 1.0) < 0.012);  // four sigmas of 0.3 %
      }
    }
  }
}

TEST_CASE("biases, misalignment and lever arms are found with their size") {
  SUBCASE("bias") {
    const SyntheticOptions options{.seed = 9, .gyro_bias = {0.0, 0.01, 0.0}, .dvl_bias = {0.03, 0.0, 0.0}};
    const auto checked = check(options);
    const auto& findings = checked.findings();
    print(findings);
    REQUIRE(find(findings, "gyro.q", "bias") != nullptr);
    CHECK(find(findings, "gyro.q", "bias")->size == doctest::Approx(-0.01).epsilon(0.05));
    REQUIRE(find(findings, "dvl.u", "bias") != nullptr);
    CHECK(find(findings, "dvl.u", "bias")->size == doctest::Approx(-0.03).epsilon(0.1));
    check_motion(checked);
  }
  SUBCASE("misalignment of the DVL, small and large") {
    for (const double angle : {0.05, -0.7}) {
      const SyntheticOptions options{
          .seed = 10, .dvl_matrix = Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ()).toRotationMatrix()};
      const auto checked = check(options);
      const auto& findings = checked.findings();
      print(findings);
      const ConsistencyFinding* one = find(findings, "dvl", "misalignment_z");
      REQUIRE(one != nullptr);
      CHECK(std::abs(one->size - angle) < 0.01);
      check_motion(checked);
    }
  }
  SUBCASE("lever arm") {
    const SyntheticOptions options{.seed = 11, .dvl_lever = {0.5, 0.0, -0.8}};
    const auto checked = check(options);
    const auto& findings = checked.findings();
    print(findings);
    REQUIRE(find(findings, "dvl", "lever_arm_x") != nullptr);
    REQUIRE(find(findings, "dvl", "lever_arm_z") != nullptr);
    CHECK(find(findings, "dvl", "lever_arm_x")->size == doctest::Approx(0.5).epsilon(0.04));
    CHECK(find(findings, "dvl", "lever_arm_z")->size == doctest::Approx(-0.8).epsilon(0.04));
    CHECK(findings.size() == 2);
    check_motion(checked);
  }
}

}  // namespace fathom

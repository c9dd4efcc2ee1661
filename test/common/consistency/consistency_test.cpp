// Clean recordings give no finding, and missing groups are worked without.
#include "common/consistency/consistency.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <random>

#include "common/base/spatial.hpp"
#include "test/support/consistency.hpp"
#include "test/support/timing.hpp"

namespace fathom {

using test::check;
using test::find;
using test::print;
using test::SyntheticOptions;

TEST_CASE("clean recordings give no finding over many seeds") {
  for (unsigned seed = 1; seed <= test::seeds(30); ++seed) {
    const std::array<double, 5> rates{10.0, 20.0, 50.0, 100.0, 200.0};
    const double rate = rates[seed % 5];
    SyntheticOptions options{.seed = seed,
                             .duration = seed % 3 == 0 ? 330.0 : 240.0,
                             .pose_rate = rate,
                             .gyro_rate = rate,
                             .dvl_rate = seed % 2 == 0 ? rate : 8.0};
    if (rate > 100.0) options.duration = 120.0;
    options.accelerometer = seed % 4 == 0;
    const std::vector<ConsistencyFinding> findings = check(options).findings();
    INFO("seed ", seed, " rate ", rate);
    CHECK(findings.empty());
    if (!findings.empty()) std::printf("seed %u rate %g\n", seed, rate);
    print(findings);
  }
}

TEST_CASE("short clean recordings give no finding either, in motion or nearly at rest about two axes") {
  for (unsigned seed = 1; seed <= test::seeds(60); ++seed) {
    const double still = seed % 2 == 0 ? 0.05 : 1.0;
    const std::vector<ConsistencyFinding> findings =
        check({.seed = seed, .duration = seed % 3 == 0 ? 40.0 : 70.0, .activity = {1, 1, 1, still, still, 1}})
            .findings();
    INFO("seed ", seed);
    CHECK(findings.empty());
    print(findings);
  }
}

TEST_CASE("velocities of the pose's own estimate accuse nobody, and hold its clock against a late gyro") {
  Recording run = test::synthetic_recording({.seed = 5, .gyro_delay = 0.12, .dvl_lever = {0.2, 0.0, 0.0}}, "run");
  const auto apart = consistency::check_consistency(std::vector{run});
  CHECK(find(apart.findings, "dvl", "lever_arm_x") != nullptr);
  run.one_estimate = true;
  const auto one = consistency::check_consistency(std::vector{run});
  for (const ConsistencyFinding& finding : one.findings) CHECK_FALSE(finding.signal.starts_with("dvl"));
  CHECK(find(one.findings, "gyro", "delay") != nullptr);
  CHECK(one.corrections[0].dvl.matrix().isIdentity());
  CHECK(one.corrections[0].pose_shift == 0.0);
  CHECK(one.corrections[0].gyro_shift == doctest::Approx(-0.12).epsilon(0.05));
}

TEST_CASE("clean recordings of few axes or little motion give no finding") {
  std::mt19937 random(77);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  for (unsigned seed = 101; seed <= 100 + test::seeds(30); ++seed) {
    SyntheticOptions options{.seed = seed, .duration = 60.0 + 300.0 * any(random)};
    options.pose_rate = options.gyro_rate = seed % 2 == 0 ? 10.0 : 25.0;
    options.dvl_rate = options.pose_rate;
    for (double& activity : options.activity) activity = any(random) < 0.5 ? 0.0 : 0.05 + any(random);
    options.accelerometer = seed % 3 == 0;
    if (seed % 5 == 0)
      options.position_noise = options.angle_noise = options.velocity_noise = options.rate_noise = options.force_noise =
          0.0;
    std::vector<Recording> runs;
    for (unsigned k = 0; k < 1 + seed % 3; ++k) {
      options.seed = seed + 1000 * k;
      runs.push_back(test::synthetic_recording(options, "run-" + std::to_string(k)));
    }
    const auto findings = consistency::check_consistency(runs).findings;
    INFO("seed ", seed);
    CHECK(findings.empty());
    if (!findings.empty())
      std::printf("seed %u: %zu runs of %.0f s, activity %.2f %.2f %.2f %.2f %.2f %.2f\n", seed, runs.size(),
                  options.duration, options.activity[0], options.activity[1], options.activity[2], options.activity[3],
                  options.activity[4], options.activity[5]);
    print(findings);
  }
}

TEST_CASE("one recording unlike the others is named and corrected alone") {
  std::vector<Recording> runs;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    runs.push_back(
        test::synthetic_recording({.seed = seed, .dvl_delay = seed == 4 ? 0.3 : 0.0}, "run-" + std::to_string(seed)));
  }
  const consistency::ConsistencyResult result = consistency::check_consistency(runs);
  print(result.findings);
  const ConsistencyFinding* one = find(result.findings, "dvl", "delay");
  REQUIRE(one != nullptr);
  CHECK(one->run == "run-4");
  CHECK(result.corrections[0].dvl.delay == 0.0);
  CHECK(result.corrections[3].dvl.delay == doctest::Approx(0.3).epsilon(0.03));
}

TEST_CASE("of three clocks the two that agree are taken to be that of the thrusters") {
  const auto shifts = [](double gyro_delay, double dvl_delay) {
    const Recording recording =
        test::synthetic_recording({.seed = 31, .gyro_delay = gyro_delay, .dvl_delay = dvl_delay});
    const estimation::Corrections one = consistency::check_consistency(std::span(&recording, 1)).corrections[0];
    return Eigen::Vector3d(one.pose_shift, one.gyro_shift, one.dvl_shift);
  };
  constexpr double kClose = 0.01;  // s; the delays' own errors are a few ms
  CHECK((shifts(0.3, 0.0) - Eigen::Vector3d(0.0, -0.3, 0.0)).norm() < kClose);      // the gyro alone is late
  CHECK((shifts(0.0, 0.3) - Eigen::Vector3d(0.0, 0.0, -0.3)).norm() < kClose);      // the velocity log alone
  CHECK((shifts(-0.2, -0.2) - Eigen::Vector3d(-0.2, 0.0, 0.0)).norm() < kClose);    // the pose alone
  CHECK((shifts(0.07, 0.22) - Eigen::Vector3d(0.07, 0.0, -0.15)).norm() < kClose);  // all differ: the gyro's
}

TEST_CASE("a position that comes late alone is found as exactly that, and every other stamp stays") {
  for (const double late : {0.04, 0.08}) {  // s
    CAPTURE(late);
    const SyntheticOptions options{.seed = 33, .accelerometer = true};
    Recording recording = test::synthetic_recording(options);
    const test::SyntheticMotion motion(options.seed);
    for (PoseCapture& pose : recording.pose_capture) {
      const double t = seconds_between(utime_after(0, 2.0), pose.utime);
      pose.p_WB += motion.p_WB(t - late) - motion.p_WB(t);
    }
    const auto result = consistency::check_consistency(std::span(&recording, 1));
    print(result.findings);
    CAPTURE(result.pairs.at("gyro").fits[0].delay);
    CAPTURE(result.pairs.at("gyro").fits[0].delay_found);
    const ConsistencyFinding* one = find(result.findings, "pose_capture.position", "delay");
    REQUIRE(one != nullptr);
    CHECK(one->size == doctest::Approx(late).epsilon(0.1));
    CHECK(result.findings.size() == 1);
    const estimation::Corrections& corrections = result.corrections.front();
    CHECK(corrections.position_late == one->size);
    CHECK(Eigen::Vector3d(corrections.pose_shift, corrections.gyro_shift, corrections.dvl_shift).isZero());
  }
}

TEST_CASE("missing groups are worked without") {
  SUBCASE("velocity only") {
    const Recording recording = test::synthetic_recording({.seed = 20, .pose_rate = 0.0, .gyro_rate = 0.0});
    const auto result = consistency::check_consistency(std::span(&recording, 1));
    CHECK(result.findings.empty());
    const Trial trial = estimation::reconstruct(recording, result.corrections[0], model::Vehicle{});
    CHECK(trial.observed.velocity);
    CHECK_FALSE(trial.observed.rates);
    CHECK_FALSE(trial.observed.position);
  }
  SUBCASE("pose only") {
    const Recording recording = test::synthetic_recording(
        {.seed = 21, .gyro_rate = 0.0, .dvl_rate = 0.0, .position_noise = 0.0005, .angle_noise = 0.0005});
    const auto result = consistency::check_consistency(std::span(&recording, 1));
    CHECK(result.findings.empty());
    const Trial trial = estimation::reconstruct(recording, result.corrections[0], model::Vehicle{});
    CHECK(trial.observed.velocity);
    CHECK(trial.observed.rates);
  }
  SUBCASE("rates only") {
    const Recording recording = test::synthetic_recording({.seed = 22, .pose_rate = 0.0, .dvl_rate = 0.0});
    const auto result = consistency::check_consistency(std::span(&recording, 1));
    CHECK(result.findings.empty());
    const Trial trial = estimation::reconstruct(recording, result.corrections[0], model::Vehicle{});
    CHECK_FALSE(trial.observed.velocity);
    CHECK(trial.observed.rates);
  }
}

TEST_CASE("an attitude sensor that sits tilted is turned, not the two that contradict it; one tilted gyro is itself") {
  std::mt19937 random{20261124};
  std::uniform_real_distribution<double> any{0.01, 0.02};  // rad
  for (unsigned seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    const Eigen::Vector3d tilt{any(random), -any(random), 0.0};
    const Eigen::Quaterniond turn = quaternion_from_rotation_vector(tilt);
    SyntheticOptions options{.seed = seed};
    options.spoil_pose = [&](PoseCapture& pose) { pose.q_WB = pose.q_WB * turn; };
    const Recording tilted = test::synthetic_recording(options);
    const consistency::ConsistencyResult result = consistency::check_consistency(std::span(&tilted, 1));
    REQUIRE(result.findings.size() == 1);
    CHECK(result.findings[0].signal == "pose_capture.attitude");
    CHECK(result.findings[0].finding == "misalignment");
    CHECK(result.findings[0].size == doctest::Approx(tilt.norm()).epsilon(0.15));
    const Eigen::Matrix3d left = turn.toRotationMatrix() * result.corrections[0].attitude_axes;
    CHECK(Eigen::AngleAxisd(left).angle() < 0.003);
    CHECK(result.corrections[0].gyro.rotation.isIdentity());
    CHECK(result.corrections[0].dvl.rotation.isIdentity());

    const Recording gyro = test::synthetic_recording({.seed = seed, .gyro_matrix = turn.toRotationMatrix()});
    const consistency::ConsistencyResult alone = consistency::check_consistency(std::span(&gyro, 1));
    CHECK(alone.corrections[0].attitude_axes.isIdentity());
    CHECK_FALSE(alone.corrections[0].gyro.rotation.isIdentity());
  }
}

}  // namespace fathom

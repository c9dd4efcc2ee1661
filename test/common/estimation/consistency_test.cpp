// Clean recordings give no finding; every injected fault is found, named and measured.
#include "common/estimation/consistency.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <ctime>

#include "common/base/statistics.hpp"
#include "common/estimation/reconstruct.hpp"
#include "test/support/synthetic_recording.hpp"
#include "test/support/timing.hpp"

namespace fathom {
namespace {

using test::SyntheticOptions;

std::vector<ConsistencyFinding> check(const SyntheticOptions& options) {
  const Recording recording = test::synthetic_recording(options);
  return estimation::check_consistency(std::span(&recording, 1)).findings;
}

const ConsistencyFinding* find(const std::vector<ConsistencyFinding>& findings, const std::string& signal,
                               const std::string& what) {
  for (const ConsistencyFinding& one : findings) {
    if (one.signal == signal && one.finding == what) return &one;
  }
  return nullptr;
}

void print(const std::vector<ConsistencyFinding>& findings) {
  for (const ConsistencyFinding& one : findings) {
    std::printf("   %s %s %s %.5g %s: %s\n", one.run.c_str(), one.signal.c_str(), one.finding.c_str(), one.size,
                one.unit.c_str(), one.evidence.c_str());
  }
}

/// Root mean square error of the reconstructed nu against the truth.
Vector6d error_of(const SyntheticOptions& options) {
  const Recording recording = test::synthetic_recording(options);
  const estimation::ConsistencyResult result = estimation::check_consistency(std::span(&recording, 1));
  const Trial trial = estimation::reconstruct(recording, result.corrections[0], model::Vehicle{});
  const test::SyntheticMotion motion(options.seed);
  // The common clock is the gyro's: its delay is part of it.
  const double block = std::max(1.0, std::round(trial.dt * options.gyro_rate));
  const double begin = 0.5 * (block - 1.0) / options.gyro_rate - options.gyro_delay;
  Vector6d sum = Vector6d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < trial.size(); ++i) {
    if (!trial.velocity_valid[i] || !trial.rates_valid[i]) continue;
    const double t = begin + trial.t[i];
    const Vector6d truth = (Vector6d() << motion.v_B(t), motion.w_B(t)).finished();
    sum += (trial.nu[i] - truth).cwiseAbs2();
    count += 1.0;
  }
  REQUIRE(count > 100.0);
  return (sum / count).cwiseSqrt();
}

constexpr double kVelocityTolerance = 0.012;  // m/s: sensor noise of 5 mm/s and what is left of the fault
constexpr double kRateTolerance = 0.008;      // rad/s: noise of 0.2 deg/s and what is left of the fault

void check_motion(const SyntheticOptions& options) {
  const Vector6d error = error_of(options);
  INFO("rmse of nu: ", error.transpose());
  CHECK(error.head<3>().maxCoeff() < kVelocityTolerance);
  CHECK(error.tail<3>().maxCoeff() < kRateTolerance);
}

}  // namespace

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
    const std::vector<ConsistencyFinding> findings = check(options);
    INFO("seed ", seed, " rate ", rate);
    CHECK(findings.empty());
    if (!findings.empty()) std::printf("seed %u rate %g\n", seed, rate);
    print(findings);
  }
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
    const auto findings = estimation::check_consistency(runs).findings;
    INFO("seed ", seed);
    CHECK(findings.empty());
    if (!findings.empty())
      std::printf("seed %u: %zu runs of %.0f s, activity %.2f %.2f %.2f %.2f %.2f %.2f\n", seed, runs.size(),
                  options.duration, options.activity[0], options.activity[1], options.activity[2], options.activity[3],
                  options.activity[4], options.activity[5]);
    print(findings);
  }
}

TEST_CASE("delays are found within their interval") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  constexpr double kTolerance = 0.008;  // s: four sigmas of the worst seed
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const double gyro = any(random), dvl = any(random);
    const std::vector<ConsistencyFinding> findings = check({.seed = seed, .gyro_delay = gyro, .dvl_delay = dvl});
    INFO("gyro ", gyro, " dvl ", dvl);
    const ConsistencyFinding* one = find(findings, "gyro", "delay");
    const ConsistencyFinding* two = find(findings, "dvl", "delay");
    REQUIRE(one != nullptr);
    REQUIRE(two != nullptr);
    CHECK(std::abs(one->size - gyro) < kTolerance);
    CHECK(std::abs(two->size - dvl) < kTolerance);
    CHECK(findings.size() == 3);  // and the clock
    if (findings.size() != 3) print(findings);
    check_motion({.seed = seed, .gyro_delay = gyro, .dvl_delay = dvl});
  }
}

TEST_CASE("stated errors cover the truth") {
  int delays = 0, biases = 0;
  double ratios = 0.0;
  constexpr unsigned kSeeds = 24;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const double delay = 0.01 * seed - 0.1;
    const Recording recording =
        test::synthetic_recording({.seed = seed, .gyro_bias = {0.01, 0.0, 0.0}, .gyro_delay = delay});
    const auto result = estimation::check_consistency(std::span(&recording, 1));
    const estimation::IncrementFit& fit = result.pairs.at("gyro").fits[0];
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
    const auto findings = check(options);
    CHECK(find(findings, "gyro.q", "sign") != nullptr);
    CHECK(findings.size() == 1);
    print(findings);
    check_motion(options);
  }
  SUBCASE("gyro axes swapped") {
    Eigen::Matrix3d swap;
    swap << 0, 1, 0, 1, 0, 0, 0, 0, 1;
    const SyntheticOptions options{.seed = 4, .gyro_matrix = swap};
    const auto findings = check(options);
    CHECK(find(findings, "gyro.p", "axes") != nullptr);
    CHECK(find(findings, "gyro.q", "axes") != nullptr);
    print(findings);
    check_motion(options);
  }
  SUBCASE("DVL in forward-left-up axes") {
    const SyntheticOptions options{.seed = 5, .dvl_matrix = Eigen::Vector3d(1, -1, -1).asDiagonal()};
    const auto findings = check(options);
    CHECK(find(findings, "dvl.v", "sign") != nullptr);
    CHECK(find(findings, "dvl.w", "sign") != nullptr);
    CHECK(findings.size() == 2);
    print(findings);
    check_motion(options);
  }
  SUBCASE("accelerometer upside down in sign") {
    const SyntheticOptions options{.seed = 6, .accelerometer = true, .force_matrix = -Eigen::Matrix3d::Identity()};
    const auto findings = check(options);
    CHECK(find(findings, "accelerometer.z", "sign") != nullptr);
    print(findings);
  }
}

TEST_CASE("units and scales are found, and which signal is to blame") {
  SUBCASE("gyro in degrees") {
    const SyntheticOptions options{.seed = 7, .gyro_matrix = 57.29578 * Eigen::Matrix3d::Identity()};
    const auto findings = check(options);
    print(findings);
    for (const char* axis : {"gyro.p", "gyro.q", "gyro.r"}) CHECK(find(findings, axis, "unit") != nullptr);
    check_motion(options);
  }
  SUBCASE("position in millimetres, centimetres, feet") {
    for (const double factor : {1000.0, 100.0, 3.28084}) {
      const SyntheticOptions options{.seed = 8, .spoil_pose = [factor](PoseCapture& pose) { pose.p_WB *= factor; }};
      const auto findings = check(options);
      print(findings);
      REQUIRE(find(findings, "pose_capture.position", "unit") != nullptr);
      CHECK(find(findings, "pose_capture.position", "unit")->size == doctest::Approx(factor));
      CHECK(findings.size() == 1);
      check_motion(options);
    }
  }
  SUBCASE("DVL a few per cent high, coverage over seeds") {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const double scale = 1.0 + 0.02 * seed;
      const SyntheticOptions options{.seed = seed, .dvl_matrix = scale * Eigen::Matrix3d::Identity()};
      const auto findings = check(options);
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
    const auto findings = check(options);
    print(findings);
    REQUIRE(find(findings, "gyro.q", "bias") != nullptr);
    CHECK(find(findings, "gyro.q", "bias")->size == doctest::Approx(-0.01).epsilon(0.05));
    REQUIRE(find(findings, "dvl.u", "bias") != nullptr);
    CHECK(find(findings, "dvl.u", "bias")->size == doctest::Approx(-0.03).epsilon(0.1));
    check_motion(options);
  }
  SUBCASE("misalignment of the DVL, small and large") {
    for (const double angle : {0.05, -0.7}) {
      const SyntheticOptions options{
          .seed = 10, .dvl_matrix = Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ()).toRotationMatrix()};
      const auto findings = check(options);
      print(findings);
      const ConsistencyFinding* one = find(findings, "dvl", "misalignment_z");
      REQUIRE(one != nullptr);
      CHECK(std::abs(one->size - angle) < 0.01);
      check_motion(options);
    }
  }
  SUBCASE("lever arm") {
    const SyntheticOptions options{.seed = 11, .dvl_lever = {0.5, 0.0, -0.8}};
    const auto findings = check(options);
    print(findings);
    REQUIRE(find(findings, "dvl", "lever_arm_x") != nullptr);
    REQUIRE(find(findings, "dvl", "lever_arm_z") != nullptr);
    CHECK(find(findings, "dvl", "lever_arm_x")->size == doctest::Approx(0.5).epsilon(0.04));
    CHECK(find(findings, "dvl", "lever_arm_z")->size == doctest::Approx(-0.8).epsilon(0.04));
    CHECK(findings.size() == 2);
    check_motion(options);
  }
}

TEST_CASE("attitude that was misread is recognised") {
  SUBCASE("inverse") {
    const SyntheticOptions options{.seed = 12,
                                   .spoil_pose = [](PoseCapture& pose) { pose.q_WB = pose.q_WB.conjugate(); }};
    const auto findings = check(options);
    print(findings);
    CHECK(find(findings, "pose_capture.attitude", "quaternion_inverse") != nullptr);
    check_motion(options);
  }
  SUBCASE("scalar last") {
    const SyntheticOptions options{.seed = 13, .spoil_pose = [](PoseCapture& pose) {
                                     pose.q_WB =
                                         Eigen::Quaterniond(pose.q_WB.x(), pose.q_WB.y(), pose.q_WB.z(), pose.q_WB.w());
                                   }};
    const auto findings = check(options);
    print(findings);
    CHECK(find(findings, "pose_capture.attitude", "quaternion_order") != nullptr);
    check_motion(options);
  }
  SUBCASE("heading offset, small and large") {
    for (const double offset : {0.06, 1.2, -2.5}) {
      const SyntheticOptions options{
          .seed = 14, .spoil_pose = [offset](PoseCapture& pose) {
            pose.q_WB = Eigen::Quaterniond(Eigen::AngleAxisd(offset, Eigen::Vector3d::UnitZ())) * pose.q_WB;
          }};
      const auto findings = check(options);
      print(findings);
      const ConsistencyFinding* one = find(findings, "pose_capture.attitude", "heading_offset");
      REQUIRE(one != nullptr);
      CHECK(std::abs(one->size - offset) < 0.01);
      check_motion(options);
    }
  }
}

TEST_CASE("depth is compared with the position") {
  const auto findings = check({.seed = 25, .depth_scale = -1.0, .depth_delay = 0.4});
  print(findings);
  REQUIRE(find(findings, "depth", "sign") != nullptr);
  REQUIRE(find(findings, "depth", "delay") != nullptr);
  CHECK(find(findings, "depth", "delay")->size == doctest::Approx(0.4).epsilon(0.15));
  CHECK(findings.size() == 2);
}

TEST_CASE("glitches, freezes, gaps and a noisy axis are reported") {
  SUBCASE("pose jumps") {
    int count = 0;
    const auto findings = check({.seed = 15, .spoil_pose = [&count](PoseCapture& pose) {
                                   if (++count % 500 == 0) pose.p_WB.x() += 0.3;
                                 }});
    print(findings);
    REQUIRE(find(findings, "pose_capture", "glitch") != nullptr);
    CHECK(find(findings, "pose_capture", "glitch")->size == doctest::Approx(9));
  }
  SUBCASE("frozen DVL") {
    Eigen::Vector3d last;
    const auto findings = check({.seed = 16, .spoil_dvl = [&last](Dvl& dvl, double t) {
                                   if (t > 100.0 && t < 110.0)
                                     dvl.v_WB_B = last;
                                   else
                                     last = dvl.v_WB_B;
                                 }});
    print(findings);
    REQUIRE(find(findings, "dvl", "frozen") != nullptr);
    CHECK(find(findings, "dvl", "frozen")->size == doctest::Approx(10.0).epsilon(0.03));
  }
  SUBCASE("lost DVL") {
    const auto findings =
        check({.seed = 17, .spoil_dvl = [](Dvl& dvl, double t) { dvl.valid = t < 50.0 || t > 53.0; }});
    print(findings);
    CHECK(find(findings, "dvl", "gap") != nullptr);
    CHECK(findings.size() == 1);
  }
  SUBCASE("one noisy axis") {
    std::mt19937 random(1);
    std::normal_distribution<double> normal(0.0, 0.1);
    const auto findings = check({.seed = 18, .spoil_dvl = [&](Dvl& dvl, double) { dvl.v_WB_B.z() += normal(random); }});
    print(findings);
    CHECK(find(findings, "dvl.w", "noise") != nullptr);
  }
}

TEST_CASE("one recording unlike the others is named and corrected alone") {
  std::vector<Recording> runs;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    runs.push_back(
        test::synthetic_recording({.seed = seed, .dvl_delay = seed == 4 ? 0.3 : 0.0}, "run-" + std::to_string(seed)));
  }
  const estimation::ConsistencyResult result = estimation::check_consistency(runs);
  print(result.findings);
  const ConsistencyFinding* one = find(result.findings, "dvl", "delay");
  REQUIRE(one != nullptr);
  CHECK(one->run == "run-4");
  CHECK(result.corrections[0].dvl.delay == 0.0);
  CHECK(result.corrections[3].dvl.delay == doctest::Approx(0.3).epsilon(0.03));
}

TEST_CASE("missing groups are worked without") {
  SUBCASE("velocity only") {
    const Recording recording = test::synthetic_recording({.seed = 20, .pose_rate = 0.0, .gyro_rate = 0.0});
    const auto result = estimation::check_consistency(std::span(&recording, 1));
    CHECK(result.findings.empty());
    const Trial trial = estimation::reconstruct(recording, result.corrections[0], model::Vehicle{});
    CHECK(trial.observed.velocity);
    CHECK_FALSE(trial.observed.rates);
    CHECK_FALSE(trial.observed.position);
  }
  SUBCASE("pose only") {
    const Recording recording = test::synthetic_recording(
        {.seed = 21, .gyro_rate = 0.0, .dvl_rate = 0.0, .position_noise = 0.0005, .angle_noise = 0.0005});
    const auto result = estimation::check_consistency(std::span(&recording, 1));
    CHECK(result.findings.empty());
    const Trial trial = estimation::reconstruct(recording, result.corrections[0], model::Vehicle{});
    CHECK(trial.observed.velocity);
    CHECK(trial.observed.rates);
  }
  SUBCASE("rates only") {
    const Recording recording = test::synthetic_recording({.seed = 22, .pose_rate = 0.0, .dvl_rate = 0.0});
    const auto result = estimation::check_consistency(std::span(&recording, 1));
    CHECK(result.findings.empty());
    const Trial trial = estimation::reconstruct(recording, result.corrections[0], model::Vehicle{});
    CHECK_FALSE(trial.observed.velocity);
    CHECK(trial.observed.rates);
  }
}

TEST_CASE("330 s at 100 Hz is checked in about a second") {
  const Recording recording = test::synthetic_recording(
      {.seed = 30, .duration = 330.0, .pose_rate = 100.0, .gyro_rate = 100.0, .dvl_rate = 100.0});
  const std::clock_t begin = std::clock();
  const auto result = estimation::check_consistency(std::span(&recording, 1));
  const double checked = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const Trial trial = estimation::reconstruct(recording, result.corrections[0], model::Vehicle{});
  const double both = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf("330 s at 100 Hz: check %.2f s, with reconstruction %.2f s of CPU time\n", checked, both);
  constexpr double kTimeLimit = 6.0;  // s: three times the goal, for slow machines
  if (test::kTimed) CHECK(both < kTimeLimit);
  CHECK(trial.dt == doctest::Approx(0.04));
}

}  // namespace fathom

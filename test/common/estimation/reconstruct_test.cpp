// From a recording to a trial: grid, choice of sources, gaps, corrections, and the input on the same clock.
#include "common/estimation/reconstruct.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "test/support/scratch.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom {
namespace {

using estimation::Corrections;
using estimation::reconstruct;

constexpr double kDuration = 60.0;  // s
constexpr double kVelocity = 0.01;  // m/s: two sigmas of the noise put in, as the mean over a run
constexpr double kRate = 0.007;     // rad/s, likewise

model::Vehicle one_thruster() {
  model::Vehicle vehicle;
  vehicle.thrusters.push_back({.name = "one"});
  vehicle.allocation.setZero(6, 1);
  vehicle.allocation(0, 0) = 1.0;
  vehicle.curve.neutral_us = 1500.0;
  vehicle.curve.pwm_us = {1400.0, 1600.0};
  vehicle.curve.force = {-10.0, 10.0};
  vehicle.curve.voltage = 15.0;
  return vehicle;
}

/// Root mean square of nu less the truth, where it is valid; `shift` is the time of the truth at the trial's start.
Vector6d error_of(const Trial& trial, unsigned seed, double shift = 0.0) {
  const test::SyntheticMotion motion(seed);
  Vector6d sum = Vector6d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < trial.size(); ++i) {
    if ((trial.velocity_valid[i] & trial.rates_valid[i]) == 0) continue;
    const double t = trial.t[i] + shift;
    sum += (trial.nu[i] - (Vector6d() << motion.v_B(t), motion.w_B(t)).finished()).cwiseAbs2();
    ++count;
  }
  return (sum / count).cwiseSqrt();
}

void check_motion(const Vector6d& error) {
  CAPTURE(error.transpose());
  CHECK(error.head<3>().maxCoeff() < kVelocity);
  CHECK(error.tail<3>().maxCoeff() < kRate);
}

}  // namespace

TEST_CASE("reconstruct: a clean run comes out on the gyro's grid with its motion") {
  const Recording recording = test::synthetic_recording({.seed = 2, .duration = kDuration});
  const Trial trial = reconstruct(recording, Corrections{}, model::Vehicle{});
  CHECK(trial.name == recording.name);
  CHECK(trial.dt == doctest::Approx(0.05));
  CHECK(trial.size() == recording.ahrs.size());
  CHECK(trial.t.front() == 0.0);
  CHECK(trial.t[100] == doctest::Approx(5.0));
  CHECK(trial.observed.position);
  CHECK(trial.observed.attitude);
  CHECK(trial.input_is_wrench);
  REQUIRE(trial.input.size() == trial.size());
  CHECK(trial.input[0].size() == 6);
  CHECK(trial.voltage.empty());
  check_motion(error_of(trial, 2));
  const test::SyntheticMotion motion(2);
  CHECK((trial.p_WB[500] - motion.p_WB(25.0)).norm() < 0.03);
  CHECK(trial.q_WB[500].angularDistance(Eigen::Quaterniond(motion.R_WB(25.0))) < 0.02);
  for (int axis = 0; axis < 6; ++axis) CHECK(trial.nu_sigma[axis] > 0.0);
}

TEST_CASE("reconstruct: a clock that leaps is named, not bridged by millions of samples") {
  Recording recording = test::synthetic_recording({.seed = 2, .duration = kDuration});
  for (std::size_t i = recording.ahrs.size() / 2; i < recording.ahrs.size(); ++i)
    recording.ahrs[i].utime += 1'700'000'000'000'000;  // us: set from 1970 to the present
  CHECK_THROWS_WITH_AS(static_cast<void>(reconstruct(recording, Corrections{}, model::Vehicle{})),
                       doctest::Contains("Does its clock leap there?"), InputError);
}

TEST_CASE("reconstruct: streams faster than 50 Hz are averaged, their means lie on the grid") {
  const Recording recording = test::synthetic_recording(
      {.seed = 3, .duration = kDuration, .pose_rate = 100.0, .gyro_rate = 100.0, .dvl_rate = 20.0});
  const Trial trial = reconstruct(recording, Corrections{}, model::Vehicle{});
  CHECK(trial.dt == doctest::Approx(0.02));
  check_motion(error_of(trial, 3, 0.005));  // the middle of the first two samples
}

TEST_CASE("reconstruct: uneven steps and lost samples leave the motion as it was, with a velocity log and without") {
  for (const double dvl_rate : {20.0, 0.0}) {
    CAPTURE(dvl_rate);
    const test::SyntheticOptions options{
        .seed = 3, .duration = kDuration, .pose_rate = 50.0, .gyro_rate = 50.0, .dvl_rate = dvl_rate};
    test::SyntheticOptions uneven = options, torn = options;
    uneven.uneven = 0.5;
    torn.missing = 0.05;
    const Vector6d even = error_of(reconstruct(test::synthetic_recording(options), Corrections{}, {}), 3);
    for (const test::SyntheticOptions& one : {uneven, torn}) {
      const Recording recording = test::synthetic_recording(one);
      const Trial trial = reconstruct(recording, Corrections{}, {});
      const double late = seconds_between(utime_after(0, 2.0), recording.ahrs.front().utime);
      const Vector6d error = error_of(trial, 3, late);
      CAPTURE(error.transpose());
      CAPTURE(even.transpose());
      CHECK((error.array() < 1.25 * even.array() + 5e-4).all());
      CHECK(std::ranges::count(trial.velocity_valid, 1) >
            static_cast<std::ptrdiff_t>(0.96 * static_cast<double>(trial.size())));
    }
  }
}

TEST_CASE("reconstruct: corrections turn, scale, shift and move what was logged") {
  const Eigen::Vector3d lever(0.3, 0.0, -0.5);
  const Recording recording = test::synthetic_recording({.seed = 4,
                                                         .duration = kDuration,
                                                         .gyro_matrix = Eigen::Vector3d(-1, -1, 1).asDiagonal(),
                                                         .dvl_matrix = 1.1 * Eigen::Matrix3d::Identity(),
                                                         .gyro_bias = {0.02, 0.0, 0.0},
                                                         .gyro_delay = 0.1,
                                                         .dvl_delay = 0.3,
                                                         .dvl_lever = lever});
  Corrections corrections;
  corrections.gyro.base = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  corrections.gyro.bias = {0.02, 0.0, 0.0};
  corrections.dvl.scale.setConstant(1.0 / 1.1);
  corrections.dvl.lever = lever;
  corrections.pose_shift = 0.1;
  corrections.dvl_shift = -0.2;
  check_motion(error_of(reconstruct(recording, corrections, model::Vehicle{}), 4, -0.1));
  corrections.dvl.lever.setZero();
  Recording without_pose = recording;
  without_pose.pose_capture.clear();  // else its derivative takes the DVL's place
  CHECK(error_of(reconstruct(without_pose, corrections, model::Vehicle{}), 4, -0.1).head<3>().maxCoeff() > kVelocity);
  corrections.dvl.lever = lever;
  check_motion(error_of(reconstruct(without_pose, corrections, model::Vehicle{}), 4, -0.1));
}

TEST_CASE("reconstruct: one source bridges the gaps of the other; where both are silent nothing is claimed") {
  Recording recording = test::synthetic_recording({.seed = 5, .duration = kDuration});
  std::erase_if(recording.dvl, [&](const Dvl& one) {
    const double t = seconds_between(recording.pose_capture.front().utime, one.utime);
    return t > 20.0 && t < 30.0;
  });
  for (std::size_t i = 500; i < 560; ++i) recording.pose_capture[i].valid = false;  // 25 to 28 s
  const Trial trial = reconstruct(recording, Corrections{}, model::Vehicle{});
  CHECK(trial.velocity_valid[440] == 1);  // 22 s: position's derivative
  CHECK(trial.velocity_valid[530] == 0);
  CHECK(trial.rates_valid[530] == 1);  // the gyro knows
  CHECK(trial.pose_valid[530] == 0);
  CHECK(trial.pose_valid[440] == 1);
  CHECK(trial.nu[530].allFinite());
  const test::SyntheticMotion motion(5);
  CHECK((trial.nu[440].head<3>() - motion.v_B(22.0)).norm() < 0.05);
  // Across the gap in a straight line: what stands there lies between its ends.
  const double left = trial.p_WB[490].x(), middle = trial.p_WB[530].x(), right = trial.p_WB[570].x();
  CHECK(middle > std::min(left, right) - 0.1);
  CHECK(middle < std::max(left, right) + 0.1);
}

TEST_CASE("reconstruct: the pose counts for nothing where the gyro contradicts it") {
  const Recording recording = test::synthetic_recording({.seed = 6, .duration = kDuration});
  Corrections corrections;
  corrections.doubtful_pose = {30.0};
  const Trial trial = reconstruct(recording, corrections, model::Vehicle{});
  CHECK(trial.pose_valid[600] == 0);
  CHECK(trial.pose_valid[580] == 1);
  CHECK(trial.pose_valid[620] == 1);
}

TEST_CASE("reconstruct: input is averaged when it is fast and interpolated when it is slow") {
  Recording recording = test::synthetic_recording({.seed = 7, .duration = kDuration});
  const Utime start = recording.ahrs.front().utime;
  const auto ramp = [&](double rate) {
    recording.thrusters.clear();
    for (int i = 0; i < static_cast<int>(kDuration * rate); ++i) {
      Thrusters one{.utime = utime_after(start, i / rate), .has_tau = true};
      one.tau[0] = 2.0 * i / rate + (i % 2 == 0 ? 1.0 : -1.0) * (rate > 100.0 ? 5.0 : 0.0);  // with a ripple when fast
      recording.thrusters.push_back(one);
    }
    return reconstruct(recording, Corrections{}, model::Vehicle{});
  };
  CHECK(ramp(4.0).input[201][0] == doctest::Approx(2.0 * 10.05));  // between 10 s and 10.25 s
  constexpr double kHalfSample = 0.01;  // N: the mean of ten samples lies between two of them
  CHECK(std::abs(ramp(200.0).input[200][0] - 2.0 * 10.0) < kHalfSample);
}

TEST_CASE("reconstruct: logged forces come first, then commands where they are trusted, then the wrench") {
  Recording recording = test::synthetic_recording({.seed = 8, .duration = kDuration});
  const model::Vehicle vehicle = one_thruster();
  for (Thrusters& one : recording.thrusters) {
    one.pwm_us = {1550.0};
    one.tau[0] = 3.0;
    recording.battery.push_back({.utime = one.utime, .voltage = 12.0});
  }
  Corrections corrections;
  Trial trial = reconstruct(recording, corrections, vehicle);
  CHECK(trial.input_is_wrench);
  CHECK(trial.input[10][0] == 3.0);
  CHECK(trial.voltage[10] == 12.0);
  corrections.thrusters = {.use_commands = true, .scale = 2.0, .exponent = 1.0};
  trial = reconstruct(recording, corrections, vehicle);
  CHECK_FALSE(trial.input_is_wrench);
  REQUIRE(trial.input[10].size() == 1);
  CHECK(trial.input[10][0] == doctest::Approx(5.0 * 2.0 * 12.0 / 15.0));
  for (Thrusters& one : recording.thrusters) one.force = {7.0};
  CHECK(reconstruct(recording, corrections, vehicle).input[10][0] == 7.0);
}

TEST_CASE("reconstruct: without motion or without input it says what is missing") {
  using test::complaint_of;
  Recording still = test::synthetic_recording(
      {.seed = 9, .duration = kDuration, .pose_rate = 0.0, .gyro_rate = 0.0, .dvl_rate = 0.0});
  const auto try_it = [](const Recording& recording) {
    return complaint_of<InputError>([&] { (void)reconstruct(recording, Corrections{}, model::Vehicle{}); });
  };
  CHECK(try_it(still) == "synthetic: no motion is recorded (neither pose, nor rates, nor velocity)");
  Recording idle = test::synthetic_recording({.seed = 9, .duration = kDuration});
  idle.thrusters.clear();
  CHECK(try_it(idle).rfind("synthetic: nothing says what drove the vehicle: no thruster forces (f1 ...), no wrench",
                           0) == 0);
}

}  // namespace fathom

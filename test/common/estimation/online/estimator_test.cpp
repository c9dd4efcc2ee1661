// The estimator on motions known at every instant, and on the Beluga recordings against the offline reconstruction.
#include "common/estimation/online/estimator.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/base/config.hpp"
#include "common/consistency/consistency.hpp"
#include "common/estimation/reconstruct.hpp"
#include "test/support/beluga_csv.hpp"
#include "test/support/feed_estimator.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom {
namespace {

using estimation::Corrections;
using estimation::Estimator;
using estimation::EstimatorSettings;

EstimatorSettings settings() {
  EstimatorSettings s;
  s.position_noise = 0.005;
  s.attitude_noise = 0.0035;
  s.depth_noise = 0.01;
  s.velocity_noise = 0.005;
  s.rate_noise = 0.0035;
  s.bias_walk = 1e-5;
  s.bias_prior = 0.01;
  s.acceleration_walk = 0.2;
  s.rate_walk = 0.3;
  s.position_cutoff = 4.0;
  s.velocity_cutoff = 15.0;
  return s;
}

struct Errors {
  double position{}, rotation{}, velocity{}, rates{};     // RMS, m rad m/s rad/s
  double nees_velocity{}, nees_rotation{}, nees_rates{};  // mean over three axes; 1 when sigma is right
  double valid{};                                         // share of estimates
};

Errors judge(const std::vector<StateEstimate>& states, unsigned seed) {
  const test::SyntheticMotion motion(seed);
  Errors e;
  double n = 0.0;
  for (const StateEstimate& state : states) {
    if (!state.valid) continue;
    const double t = seconds_between(0, state.utime) - 2.0;  // recordings begin at 2 s
    if (t < 10.0) continue;
    n += 1.0;
    const Eigen::Vector3d dv = state.nu.head<3>() - motion.v_B(t), dw = state.nu.tail<3>() - motion.w_B(t);
    const Eigen::Vector3d dp = state.p_WB - motion.p_WB(t);
    const Eigen::Vector3d dr =
        rotation_vector_from_quaternion(state.q_WB.conjugate() * Eigen::Quaterniond(motion.R_WB(t)));
    e.position += dp.squaredNorm() / 3.0;
    e.rotation += dr.squaredNorm() / 3.0;
    e.velocity += dv.squaredNorm() / 3.0;
    e.rates += dw.squaredNorm() / 3.0;
    e.nees_rotation += dr.cwiseQuotient(state.sigma.segment<3>(3)).squaredNorm() / 3.0;
    e.nees_velocity += dv.cwiseQuotient(state.sigma.segment<3>(6)).squaredNorm() / 3.0;
    e.nees_rates += dw.cwiseQuotient(state.sigma.tail<3>()).squaredNorm() / 3.0;
  }
  for (double* one : {&e.position, &e.rotation, &e.velocity, &e.rates}) *one = std::sqrt(*one / n);
  for (double* one : {&e.nees_velocity, &e.nees_rotation, &e.nees_rates}) *one /= n;
  e.valid = n / static_cast<double>(states.size());
  return e;
}

}  // namespace

TEST_CASE("estimator: stays within bounds of a known motion, and its stated errors are the true ones") {
  for (const bool accelerometer : {false, true}) {
    CAPTURE(accelerometer);
    Errors mean;
    constexpr int kSeeds = 10;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      test::SyntheticOptions options{.seed = seed, .duration = 60.0};
      options.accelerometer = accelerometer;
      EstimatorSettings s = settings();
      if (accelerometer) {
        s.acceleration_walk = 0.015;  // 0.05 m/s^2 at 20 Hz, and what sampling adds
        s.position_cutoff = 2.0;
      }
      Estimator estimator{s, Corrections{}};
      const Errors e = judge(test::feed(estimator, test::synthetic_recording(options)), seed);
      CHECK(e.valid > 0.8);
      CHECK(e.position < 0.01);                           // m; the fixes have 0.005
      CHECK(e.rotation < 0.0035);                         // rad; better than one fix
      CHECK(e.velocity < (accelerometer ? 0.01 : 0.07));  // m/s
      CHECK(e.rates < 0.006);                             // rad/s; a gyro sample has 0.0035
      mean.nees_velocity += e.nees_velocity / kSeeds;
      mean.nees_rotation += e.nees_rotation / kSeeds;
      mean.nees_rates += e.nees_rates / kSeeds;
    }
    // Errors of neighbouring estimates are alike and the walk is a guess of a smooth motion: within a factor of two.
    MESSAGE("NEES/3 velocity " << mean.nees_velocity << " rotation " << mean.nees_rotation << " rates "
                               << mean.nees_rates);
    for (const double nees : {mean.nees_velocity, mean.nees_rotation, mean.nees_rates}) {
      CHECK(nees > 0.4);
      CHECK(nees < 2.0);
    }
  }
}

TEST_CASE("estimator: without a gyro the rates come from the attitudes") {
  test::SyntheticOptions options{.duration = 60.0};
  options.gyro_rate = 0.0;
  EstimatorSettings s = settings();
  s.attitude_cutoff = 8.0;
  Estimator estimator{s, Corrections{}};
  const Errors e = judge(test::feed(estimator, test::synthetic_recording(options)), options.seed);
  CHECK(e.valid > 0.8);
  CHECK(e.rates < 0.15);  // rad/s, of a motion with 0.9 rad/s; the filter lags 2 zeta/w = 0.2 s behind
}

TEST_CASE("estimator: signs, scale, bias, lever and delays are taken out by the corrections") {
  test::SyntheticOptions clean{.duration = 60.0}, faulty = clean;
  faulty.gyro_matrix = Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal();
  faulty.gyro_bias = {0.01, 0.02, -0.03};
  faulty.gyro_delay = 0.07;
  faulty.dvl_matrix *= 1.025;
  faulty.dvl_lever = {0.3, 0.1, -0.2};
  faulty.dvl_delay = 0.22;
  Corrections c;
  c.gyro.base = faulty.gyro_matrix;
  c.gyro.bias = -faulty.gyro_matrix * faulty.gyro_bias;
  c.gyro_shift = -faulty.gyro_delay;
  c.dvl.base *= 1.0 / 1.025;
  c.dvl.lever = faulty.dvl_lever;
  c.dvl_shift = -faulty.dvl_delay;
  Estimator blind{settings(), Corrections{}}, seeing{settings(), c};
  const Recording recording = test::synthetic_recording(faulty);
  CHECK(judge(test::feed(blind, recording), 1).velocity > 0.15);
  const Errors e = judge(test::feed(seeing, recording), 1);
  CHECK(e.velocity < 0.07);  // m/s, as without faults
  CHECK(e.rates < 0.006);    // rad/s
  CHECK(e.valid > 0.8);
}

TEST_CASE("estimator: the order in which channels arrive does not change a bit") {
  const Recording recording = test::synthetic_recording({.duration = 20.0});
  Estimator prompt{settings(), Corrections{}}, late{settings(), Corrections{}};
  const auto a = test::feed(prompt, recording);
  const auto b = test::feed(late, recording, 200'000);  // us, less than the latency
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i].utime == b[i].utime);
    CHECK(a[i].nu == b[i].nu);
    CHECK(a[i].q_WB.coeffs() == b[i].q_WB.coeffs());
  }
  CHECK(late.rejected() == prompt.rejected());
}

TEST_CASE("estimator: gaps make it say so, glitches and frozen or held samples are not believed") {
  test::SyntheticOptions options{.duration = 60.0};
  options.spoil_pose = [](PoseCapture& pose) {
    const double t = seconds_between(0, pose.utime) - 2.0;
    if (t > 20.0 && t < 25.0) pose.valid = false;
    if (std::fmod(t, 3.0) < 0.04) pose.p_WB += Eigen::Vector3d(0.5, 0.0, 0.0);  // m: a glitch
  };
  options.spoil_dvl = [](Dvl& dvl, double t) {
    if (t > 19.0 && t < 25.0) dvl.valid = false;
    if (static_cast<int>(10.0 * t) % 5 == 0) {
      dvl.held = true;
      dvl.v_WB_B.setConstant(3.0);
    }
  };
  EstimatorSettings s = settings();
  s.max_gap = 0.3;
  Estimator estimator{s, Corrections{}};
  const auto states = test::feed(estimator, test::synthetic_recording(options));
  for (const StateEstimate& state : states) {
    const double t = seconds_between(0, state.utime) - 2.0;
    CHECK(state.nu.allFinite());
    CHECK(state.sigma.allFinite());
    if (t > 22.0 && t < 24.9) CHECK_FALSE(state.valid);
    if (t > 30.0) CHECK(state.valid);
  }
  CHECK(judge(states, 1).position < 0.02);  // m; each glitch is 0.5 m
  CHECK(judge(states, 1).velocity < 0.07);  // m/s
  CHECK(estimator.rejected().at("position gated") > 10);
  CHECK(estimator.rejected().at("dvl held") > 100);
}

TEST_CASE("estimator: depth with another zero than the capture's bridges a gap of the capture without a step") {
  test::SyntheticOptions options{.duration = 60.0};
  options.spoil_pose = [](PoseCapture& pose) {
    const double t = seconds_between(0, pose.utime) - 2.0;
    if (t > 30.0 && t < 50.0) pose.has_position = false;
  };
  Estimator estimator{settings(), Corrections{}};
  const test::SyntheticMotion motion(options.seed);
  for (const StateEstimate& state : test::feed(estimator, test::synthetic_recording(options))) {
    const double t = seconds_between(0, state.utime) - 2.0;
    if (t > 10.0) CHECK(std::abs(state.p_WB.z() - motion.p_WB(t).z()) < 0.06);  // m; the zeros differ by 0.4 m
  }
}

TEST_CASE("estimator: a reset is a new estimator") {
  const Recording recording = test::synthetic_recording({.duration = 15.0});
  Estimator estimator{settings(), Corrections{}};
  const auto first = test::feed(estimator, recording);
  estimator.reset();
  const auto second = test::feed(estimator, recording);
  REQUIRE(first.size() == second.size());
  CHECK(first.back().nu == second.back().nu);
}

TEST_CASE("estimator: follows the offline reconstruction of a Beluga run with that run's own configuration") {
  const Recording recording = test::read_beluga("random-1");
  const std::vector<Recording> one{recording};
  const auto checked = consistency::check_consistency(one);
  const model::Vehicle vehicle = model::Vehicle::load(std::string(FATHOM_SOURCE_DIR) + "/config/vehicles/beluga.yaml");
  const Trial trial = estimation::reconstruct(recording, checked.corrections.front(), vehicle);
  const Config pipeline = Config::load(std::string(FATHOM_SOURCE_DIR) + "/config/pipelines/beluga.yaml");
  Estimator estimator{EstimatorSettings::from(pipeline.section("estimator")), checked.corrections.front()};
  const auto states = test::feed(estimator, recording);
  Vector6d error = Vector6d::Zero(), signal = Vector6d::Zero();
  double n = 0.0, valid = 0.0;
  for (const StateEstimate& state : states) {
    valid += state.valid ? 1.0 : 0.0;
    const auto k = static_cast<std::size_t>(std::lround(seconds_between(0, state.utime) / trial.dt));
    if (!state.valid || k >= trial.size() || !trial.velocity_valid[k] || !trial.rates_valid[k]) continue;
    error += (state.nu - trial.nu[k]).cwiseAbs2();
    signal += trial.nu[k].cwiseAbs2();
    n += 1.0;
  }
  const Vector6d rms = (error / n).cwiseSqrt();
  MESSAGE("rms difference " << rms.transpose() << " of " << (signal / n).cwiseSqrt().transpose());
  CHECK(valid / static_cast<double>(states.size()) > 0.95);
  for (int i = 0; i < 3; ++i) CHECK(rms[i] < 0.03);  // m/s; the causal filter may lag, the reconstruction does not
  for (int i = 3; i < 6; ++i) CHECK(rms[i] < 0.02);  // rad/s
}

}  // namespace fathom

// Masses back from noisy motion, where the raw accelerometer attenuates them; and the window's manners.
#include "common/identification/integral_regressor.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <string>

#include "common/base/error.hpp"
#include "common/identification/recursive.hpp"
#include "common/model/regressor.hpp"
#include "test/common/identification/karras_vehicle.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr double kVelocityNoise = 0.005;     // m/s per sample, as an estimator delivers it
constexpr double kRateNoise = 0.005;         // rad/s
constexpr double kAccelerometerNoise = 0.3;  // m/s^2 per sample
constexpr double kYawAccelerationNoise = 0.3;
constexpr double kDt = 0.05;

std::vector<model::BaseParameter> table_parameters() {
  std::vector<model::BaseParameter> list;
  list.reserve(std::size(test::kTableNames));
  for (const std::string& name : test::kTableNames) list.push_back(model::parameter_from_name(name).value());
  return list;
}

IntegralSettings four_axes() {
  IntegralSettings s;
  s.dof = {true, true, true, false, false, true};
  s.sigma << 0.1, 0.1, 0.1, 0.02, 0.02, 0.02;
  s.parameters = table_parameters();
  return s;
}

RecursiveEstimator zero_prior() {
  RecursiveSettings s;
  s.mean = ParameterVector::Zero(13);
  s.sigma = ParameterVector::Constant(13, 100.0);
  for (std::size_t i = 0; i < 12; ++i) s.signs[i] = i < 4 ? 1 : -1;
  return RecursiveEstimator{s};
}

Vector6d six(const Eigen::Vector4d& x) {
  Vector6d full = Vector6d::Zero();
  full << x(0), x(1), x(2), 0.0, 0.0, x(3);
  return full;
}

MotionSample as_sample(const test::Truth& truth) {
  MotionSample s;
  s.utime = utime_after(1'600'000'000'000'000, truth.t);
  s.nu = six(truth.nu);
  s.tau = six(truth.tau);
  s.valid = true;
  return s;
}

void disturb(Vector6d& nu, std::mt19937& engine) {
  std::normal_distribution<double> normal;
  for (int i = 0; i < 6; ++i) nu(i) += (i < 3 ? kVelocityNoise : kRateNoise) * normal(engine);
}

RecursiveReport identify(const std::vector<test::Truth>& run, bool noisy, unsigned seed) {
  std::mt19937 engine{seed};
  IntegralRegressor regressor{four_axes()};
  RecursiveEstimator estimator = zero_prior();
  for (const test::Truth& truth : run) {
    MotionSample s = as_sample(truth);
    if (noisy) disturb(s.nu, engine);
    if (const auto block = regressor.step(s)) estimator.step(block->view());
  }
  return estimator.report();
}

// What the paper suggests at first sight: accelerometer and gyro difference straight into the regressor.
RecursiveReport identify_naively(const std::vector<test::Truth>& run, unsigned seed) {
  std::mt19937 engine{seed};
  std::normal_distribution<double> normal;
  RecursiveEstimator estimator = zero_prior();
  std::array<Row, 4> rows;
  const std::vector<model::BaseParameter> columns = table_parameters();
  constexpr std::array<int, 4> kAxes{0, 1, 2, 5};
  for (const test::Truth& truth : run) {
    Vector6d nu = six(truth.nu);
    disturb(nu, engine);
    Vector6d nu_dot = six(truth.dot);
    for (int i = 0; i < 3; ++i) nu_dot(i) += kAccelerometerNoise * normal(engine);
    nu_dot(5) += kYawAccelerationNoise * normal(engine);
    const model::BaseRegressor Y = model::base_regressor(nu_dot, nu, Eigen::Matrix3d::Identity());
    for (std::size_t i = 0; i < 4; ++i) {
      rows[i].axis = kAxes[i];
      rows[i].h.resize(13);
      for (int j = 0; j < 13; ++j) rows[i].h(j) = Y(kAxes[i], model::index(columns[static_cast<std::size_t>(j)]));
      rows[i].y = truth.tau(static_cast<Eigen::Index>(i));
      rows[i].variance = 1.0;
    }
    estimator.step(rows);
  }
  return estimator.report();
}

}  // namespace

TEST_CASE("integral regressor: masses come back within 3 % where the raw accelerometer attenuates them") {
  constexpr double kTolerance = 0.03;
  const std::vector<test::Truth> run = test::karras_run(330.0, kDt, 1);
  const RecursiveReport integral = identify(run, true, 21);
  const RecursiveReport naive = identify_naively(run, 21);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double truth = test::kTable[static_cast<std::size_t>(i)];
    const std::string& name = test::kTableNames[static_cast<std::size_t>(i)];
    CHECK_MESSAGE(std::abs(integral.estimate(i) / truth - 1.0) < kTolerance, name);
    MESSAGE(name << ": integral " << 100.0 * (integral.estimate(i) / truth - 1.0) << " %, raw accelerometer "
                 << 100.0 * (naive.estimate(i) / truth - 1.0) << " % (claimed sigma "
                 << 100.0 * integral.sigma(i) / truth << " %)");
    if (i < 3) CHECK_MESSAGE(naive.estimate(i) < 0.85 * truth, name);
  }
}

TEST_CASE("integral regressor: without noise all 13 numbers of Table 1.1 return") {
  constexpr double kTolerance = 2e-4;  // trapezoidal rule at 20 Hz on |u|u, which bends where u changes sign
  const RecursiveReport report = identify(test::karras_run(330.0, kDt, 2), false, 0);
  for (Eigen::Index i = 0; i < 13; ++i) {
    const double truth = test::kTable[static_cast<std::size_t>(i)];
    CHECK_MESSAGE(std::abs(report.estimate(i) - truth) < kTolerance * std::max(1.0, std::abs(truth)),
                  test::kTableNames[static_cast<std::size_t>(i)]);
  }
}

TEST_CASE(
    "integral regressor: under noise all 13 stay within four claimed sigmas, and velocity noise biases masses little") {
  constexpr int kTrials = 20;
  Eigen::Matrix<double, 13, 1> bias = Eigen::Matrix<double, 13, 1>::Zero();
  double nees = 0.0;
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    const RecursiveReport report = identify(test::karras_run(330.0, kDt, 40 + trial), true, 60 + trial);
    for (Eigen::Index i = 0; i < 13; ++i) {
      const double error = report.estimate(i) - test::kTable[static_cast<std::size_t>(i)];
      CHECK_MESSAGE(
          std::abs(error) < 4.0 * report.sigma(i) + 0.01 * std::abs(test::kTable[static_cast<std::size_t>(i)]),
          test::kTableNames[static_cast<std::size_t>(i)]);
      bias(i) += error / kTrials;
      nees += error * error / (report.sigma(i) * report.sigma(i)) / (13.0 * kTrials);
    }
  }
  for (Eigen::Index i = 0; i < 13; ++i) {
    MESSAGE(test::kTableNames[static_cast<std::size_t>(i)]
            << ": bias " << 100.0 * bias(i) / std::abs(test::kTable[static_cast<std::size_t>(i)]) << " %");
    constexpr double kLargestBias = 0.01;  // errors in variables: about (4 mm/s^2 / 0.2 m/s^2)^2, plus chance
    if (i < 3) CHECK(std::abs(bias(i)) < kLargestBias * test::kTable[static_cast<std::size_t>(i)]);
  }
  MESSAGE("mean squared error over claimed variance: " << nees);
}

TEST_CASE("integral regressor: constant acceleration and constant force are exact, whatever the sample times") {
  constexpr double kTolerance = 1e-6;  // stamps are whole microseconds of a second
  std::mt19937 engine{3};
  std::uniform_real_distribution<double> jitter{0.8, 1.2};
  IntegralRegressor regressor{four_axes()};
  int blocks = 0;
  double t = 0.0;
  for (int i = 0; i < 400; ++i) {
    t += 0.1 * jitter(engine);
    test::Truth truth;
    truth.t = t;
    MotionSample s = as_sample(truth);
    s.nu(0) = 2.0 + 0.05 * t;
    s.tau(0) = 7.0;
    if (const auto block = regressor.step(s)) {
      ++blocks;
      CHECK(block->rows[0].h(0) == doctest::Approx(0.05).epsilon(kTolerance * 100));
      CHECK(block->rows[0].y == doctest::Approx(7.0).epsilon(kTolerance));
      CHECK(block->count == 4);
    }
  }
  CHECK(blocks > 60);
}

TEST_CASE("integral regressor: slightly irregular samples cost little") {
  constexpr double kTolerance = 0.01;  // 20 % jitter at 20 Hz: second order in the interval
  const std::vector<test::Truth> fine = test::karras_run(330.0, kDt / 10.0, 5);
  std::mt19937 engine{8};
  std::uniform_int_distribution<int> jitter{8, 12};
  IntegralRegressor regressor{four_axes()};
  RecursiveEstimator estimator = zero_prior();
  for (std::size_t i = 0; i < fine.size(); i += static_cast<std::size_t>(jitter(engine))) {
    if (const auto block = regressor.step(as_sample(fine[i]))) estimator.step(block->view());
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    CHECK(std::abs(estimator.projected()(i) / test::kTable[static_cast<std::size_t>(i)] - 1.0) < kTolerance);
  }
}

TEST_CASE("integral regressor: no window spans a gap, an invalid sample or a jump back in time") {
  IntegralSettings s = four_axes();
  s.window = 1.0;
  s.stride = 0.1;
  for (int fault = 0; fault < 3; ++fault) {
    IntegralRegressor regressor{s};
    const std::vector<test::Truth> run = test::karras_run(10.0, kDt, 1);
    Utime restart = 0;
    int before = 0;
    int after = 0;
    for (std::size_t i = 0; i < run.size(); ++i) {
      MotionSample sample = as_sample(run[i]);
      if (i == 100 && fault == 1) sample.valid = false;
      if (i >= 100 && fault == 0) sample.utime += 500'000;
      if (i >= 100 && fault == 2) sample.utime -= 5'000'000;
      if (i == 100) restart = sample.utime;
      const auto block = regressor.step(sample);
      if (!block) continue;
      (i < 100 ? before : after) += 1;
      if (i >= 100) CHECK(seconds_between(restart, block->end) >= 0.79);
    }
    CHECK(before > 30);
    CHECK(after > 30);
  }
}

TEST_CASE("integral regressor: refuses settings without sense") {
  IntegralSettings s = four_axes();
  s.window = 0.0;
  CHECK_THROWS_AS((IntegralRegressor{s}), InputError);
  s = four_axes();
  s.parameters.clear();
  CHECK_THROWS_AS((IntegralRegressor{s}), InputError);
}

TEST_CASE("integral regressor: rows are as uncertain as the velocities that they are made of") {
  IntegralSettings s = four_axes();
  s.per_velocity = {20.0, 10.0, 30.0};
  s.ordinary_sigma_v = 0.01;
  s.mass = {10.0, 14.0, 12.0};
  const auto rows = [&](double sigma_v) {
    IntegralRegressor regressor{s};
    std::optional<RowBlock> last;
    for (int i = 0; i < 100; ++i) {
      MotionSample sample{.utime = utime_after(1'600'000'000'000'000, kDt * i), .valid = true};
      sample.nu << 0.4, 0.3, 0.0, 0.0, 0.0, 0.0;
      sample.sigma_v.setConstant(sigma_v);
      if (auto block = regressor.step(sample)) last = block;
    }
    REQUIRE(last);
    return *last;
  };
  const auto moment = [](double sigma_v) { return std::pow((14.0 - 10.0) * std::hypot(0.4, 0.3) * sigma_v, 2); };
  const RowBlock ordinary = rows(0.008), worse = rows(0.03);
  const double excess = 0.03 * 0.03 - 0.01 * 0.01;
  for (std::size_t i = 0; i < 3; ++i) {
    const double per = s.per_velocity(static_cast<Eigen::Index>(i));
    CHECK(ordinary.rows[i].variance == doctest::Approx(0.01));
    CHECK(worse.rows[i].variance == doctest::Approx(0.01 + per * per * excess));
  }
  CHECK(ordinary.rows[3].variance == doctest::Approx(0.02 * 0.02 + moment(0.008)));
  CHECK(worse.rows[3].variance == doctest::Approx(0.02 * 0.02 + moment(0.03)));
}

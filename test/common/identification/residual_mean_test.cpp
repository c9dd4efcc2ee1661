// When a residual counts as one-sided beside what is known of the attitude sensor.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/identification/identifier.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr double kRighting = 2.3;  // N m
constexpr double kOff = 0.0035;    // rad: 0.2 deg
constexpr double kMoment = 0.02;   // N m, as stated
constexpr Utime kStart = 1'600'000'000'000'000;

model::Vehicle roller() {
  model::Vehicle v;
  v.name = "roller";
  v.dof = {true, true, true, true, false, true};
  v.allocation = Eigen::Matrix<double, 6, Eigen::Dynamic>::Identity(6, 6);
  v.parameters = {"I_X", "K_p", "G_y", "G_z"};
  v.priors = {{.mean = 0.3, .sigma = 0.1},
              {.mean = -0.5, .sigma = 0.3},
              {.mean = 0.0, .sigma = 0.1},
              {.mean = kRighting, .sigma = 1.0}};
  return v;
}

/// Mean of the residual on K, in its own deviations, after a roll that is driven; the sensor reads `off` too much in
/// the last 40 s of 300, its gyro by `drift`, or somebody leans on the vehicle by `push`.
ModelEstimate model_of_roll(double attitude_offset, double off, double push, double rate_offset = 0.0,
                            double drift = 0.0) {
  IdentifierSettings settings;
  settings.window = 1.0;
  settings.stride = 0.25;
  settings.noise_moment = kMoment;
  settings.noise_force = 0.1;
  settings.residual_memory = 30.0;
  settings.attitude_offset = attitude_offset;
  settings.rate_offset = rate_offset;
  const model::Vehicle vehicle = roller();
  Identifier identifier{settings, vehicle};
  std::mt19937 engine{3};
  std::normal_distribution<double> normal;
  double roll = 0.0, rate = 0.0;
  constexpr double kStep = 0.01;
  for (int i = 0; i < 30000; ++i) {
    const double t = kStep * i;
    const bool late = t > 260.0;
    const double drive = 0.5 * std::sin(0.9 * t) + 0.3 * std::sin(2.3 * t);
    const Utime utime = utime_after(kStart, t);
    StateEstimate state{
        .utime = utime,
        .q_WB = Eigen::Quaterniond{Eigen::AngleAxisd{roll + (late ? off : 0.0), Eigen::Vector3d::UnitX()}},
        .valid = true};
    state.nu << 0.0, 0.0, 0.0, rate + (late ? drift : 0.0) + 0.003 * normal(engine), 0.0, 0.0;
    Thrusters thrusters{.utime = utime, .has_tau = true};
    thrusters.tau = {0.0, 0.0, 0.0, drive, 0.0, 0.0};
    (void)identifier.step(thrusters);
    (void)identifier.step(state);
    const double unrest = 0.15 * normal(engine);  // as large as stated in the mean of a second
    const double moment = unrest + drive + (late ? push : 0.0) - 0.5 * rate - kRighting * std::sin(roll);
    rate += kStep * moment / 0.3;
    roll += kStep * rate;
  }
  return identifier.model();
}

}  // namespace

TEST_CASE("identifier: what a wandering level makes of the righting moment is not one-sided") {
  const double wander = 4.0 * kOff;
  CHECK(std::abs(model_of_roll(0.0, wander, 0.0).residual_mean[3]) > 4.0);  // were the level known exactly, it would be
  CHECK(std::abs(model_of_roll(kOff, wander, 0.0).residual_mean[3]) < 3.0);
  // What cannot be the level still stops a mode from being left, by its mean or, as here, by its power.
  CHECK(model_of_roll(kOff, 0.0, 12.0 * kRighting * kOff).residual_ratio[3] > 2.0);
}

TEST_CASE("identifier: what drag makes of a gyro's bias is not one-sided") {
  constexpr double kBias = 0.02;  // rad/s: through this drag of 0.5 N m/(rad/s) half of the stated noise
  CHECK(std::abs(model_of_roll(0.0, 0.0, 0.0, 0.0, 3.0 * kBias).residual_mean[3]) > 4.0);
  CHECK(std::abs(model_of_roll(0.0, 0.0, 0.0, kBias, 3.0 * kBias).residual_mean[3]) < 3.0);
  // A push that no such bias makes stops a mode from being left all the same, here by its power.
  CHECK(model_of_roll(0.0, 0.0, 0.1, kBias, 0.0).residual_ratio[3] > 2.0);
}

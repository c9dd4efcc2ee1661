// Corrections through their file, and the one set that most recordings share.
#include "common/estimation/corrections_file.hpp"

#include <doctest/doctest.h>

#include "common/base/error.hpp"
#include "common/estimation/split.hpp"
#include "common/estimation/thruster_forces.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

using estimation::Corrections;
constexpr double kPrinted = 1e-8;  // nine digits are written

Corrections faulty() {
  Corrections c;
  c.quaternion = estimation::QuaternionForm::kScalarLast;
  c.heading = 0.25;
  c.position_scale = 0.001;
  c.position_axes = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  c.gyro.base = Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal();
  c.gyro.rotation = rotation_from_euler({0.01, 0.02, 0.03});
  c.gyro.bias = {1e-3, -2e-3, 3e-3};
  c.dvl.scale = {0.978, 0.98, 0.99};
  c.dvl.lever = {0.1, 0.2, 0.3};
  c.dvl.coupling << 1e-3, 2e-3, 0, 2e-3, 0, 0, 0, 0, 4e-3;
  c.accelerometer.lever = {0.01, 0.02, 0.03};
  c.pose_shift = 0.0724;
  c.dvl_shift = -0.15;
  c.thrusters = {.use_commands = true, .scale = 1.1, .exponent = 0.5};
  return c;
}

}  // namespace

TEST_CASE("corrections: a file gives back what was written") {
  const test::Scratch scratch;
  const Corrections c = faulty();
  test::write_bytes(scratch.path("c.yaml"), to_yaml(c));
  const Corrections back = estimation::load_corrections(scratch.path("c.yaml"));
  CHECK(back.quaternion == c.quaternion);
  CHECK(back.heading == doctest::Approx(c.heading).epsilon(kPrinted));
  CHECK(back.position_scale == doctest::Approx(c.position_scale).epsilon(kPrinted));
  CHECK(back.position_axes.isApprox(c.position_axes, kPrinted));
  CHECK(back.gyro.matrix().isApprox(c.gyro.matrix(), kPrinted));
  CHECK(back.gyro.bias.isApprox(c.gyro.bias, kPrinted));
  CHECK(back.dvl.matrix().isApprox(c.dvl.matrix(), kPrinted));
  CHECK((skew(back.dvl.lever) + back.dvl.coupling).isApprox(skew(c.dvl.lever) + c.dvl.coupling, kPrinted));
  CHECK(back.accelerometer.lever.isApprox(c.accelerometer.lever, kPrinted));
  CHECK(back.pose_shift == doctest::Approx(c.pose_shift).epsilon(kPrinted));
  CHECK(back.dvl_shift == doctest::Approx(c.dvl_shift).epsilon(kPrinted));
  CHECK(back.thrusters.use_commands);
  CHECK(back.thrusters.scale == doctest::Approx(1.1).epsilon(kPrinted));
  CHECK(back.thrusters.exponent == doctest::Approx(0.5).epsilon(kPrinted));
  CHECK(to_yaml(back) == to_yaml(c));
}

TEST_CASE("corrections: the empty file corrects nothing, an unknown key is refused") {
  const std::string none = std::string{FATHOM_SOURCE_DIR} + "/config/corrections/none.yaml";
  CHECK(to_yaml(estimation::load_corrections(none)) == to_yaml(Corrections{}));
  const test::Scratch scratch;
  test::write_bytes(scratch.path("c.yaml"), "corrections:\n  giro: {}\n");
  CHECK(test::complaint_of<InputError>([&] {
          (void)estimation::load_corrections(scratch.path("c.yaml"));
        }).find("c.yaml:2") != std::string::npos);
}

TEST_CASE("corrections: the set that most recordings share is taken") {
  const std::vector<Corrections> all{faulty(), Corrections{}, faulty()};
  const estimation::Shared shared = estimation::most_shared(all);
  CHECK(shared.count == 2);
  CHECK(shared.corrections.pose_shift == faulty().pose_shift);
}

TEST_CASE("thruster forces: commands become forces only where the correction trusts them") {
  model::Vehicle vehicle;
  vehicle.thrusters.resize(2);
  vehicle.thrusters[1].pwm_sign = -1.0;
  vehicle.curve = {.pwm_us = {1400.0, 1500.0, 1600.0},
                   .force = {-10.0, 0.0, 20.0},
                   .neutral_us = 1500.0,
                   .voltage = 16.0,
                   .voltage_exponent = 1.0};
  const Thrusters commanded{.utime = 5, .pwm_us = {1550.0, 1550.0}};
  estimation::ThrusterForces logged{{.use_commands = false}, vehicle};
  CHECK(logged.step(commanded).force.empty());
  estimation::ThrusterForces curve{{.use_commands = true, .scale = 2.0}, vehicle};
  curve.step(Battery{4, 8.0});  // half the voltage
  const Thrusters result = curve.step(commanded);
  REQUIRE(result.force.size() == 2);
  CHECK(result.force[0] == doctest::Approx(2.0 * 0.5 * 10.0));
  CHECK(result.force[1] == doctest::Approx(2.0 * 0.5 * -5.0));  // mirrored about neutral: 1450 us
}

TEST_CASE("split: nothing is lost, nothing doubled, and a run of one sample is refused") {
  Trial trial;
  trial.name = "dive";
  trial.dt = 0.1;
  for (int i = 0; i < 10; ++i) {
    trial.t.push_back(0.5 + 0.1 * i);
    trial.nu.push_back(Vector6d::Constant(i));
    trial.input.push_back(Eigen::VectorXd::Constant(6, i));
  }
  const auto [first, last] = estimation::split(trial, 0.3);
  CHECK(first.size() == 7);
  CHECK(last.size() == 3);
  CHECK(last.nu.front()[0] == 7.0);
  CHECK(last.input.size() == 3);
  CHECK(last.t.front() == doctest::Approx(1.2));  // time goes on: what began in the first part goes on too
  CHECK(first.name == "dive (first 70 %)");
  CHECK(last.name == "dive (last 30 %)");
  trial.t.resize(1);
  CHECK_THROWS_AS((void)estimation::split(trial, 0.3), InputError);
}

}  // namespace fathom

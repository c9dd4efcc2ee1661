// The logged wrench against the one of the commands: a factor, a voltage and a curve that is not the one used on board
// are told apart; and whose clock thrusters are on.
#include <doctest/doctest.h>

#include <cmath>

#include "common/consistency/consistency.hpp"
#include "common/consistency/thruster_clock.hpp"
#include "test/support/consistency.hpp"

namespace fathom::consistency {
namespace {

using test::find;

model::Vehicle one_thruster() {
  model::Vehicle vehicle;
  vehicle.nominal_voltage = 16.0;
  vehicle.curve = {
      .pwm_us = {1100.0, 1500.0, 1900.0}, .force = {-40.0, 0.0, 40.0}, .neutral_us = 1500.0, .voltage = 16.0};
  vehicle.thrusters.resize(1);
  vehicle.allocation = Eigen::MatrixXd::Zero(6, 1);
  vehicle.allocation(0, 0) = 1.0;
  return vehicle;
}

/// X is `factor` (V / 16 V)^exponent times what the curve makes of the pulse; the voltage falls from 16.8 to 14 V.
Recording driven(double factor, double exponent, bool by_curve = true) {
  Recording recording;
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.1 * i, volts = 16.8 - 2.8 * i / 2000.0, force = 30.0 * std::sin(0.7 * t);
    Battery battery;
    battery.utime = utime_after(0, t);
    battery.voltage = volts;
    recording.battery.push_back(battery);
    Thrusters thrusters;
    thrusters.utime = battery.utime;
    thrusters.pwm_us = {1500.0 + 10.0 * force};
    thrusters.has_tau = true;
    thrusters.tau[0] = by_curve ? factor * std::pow(volts / 16.0, exponent) * force : 30.0 * std::cos(0.31 * t);
    recording.thrusters.push_back(thrusters);
  }
  return recording;
}

ConsistencyResult checked(const Recording& recording) {
  ConsistencyResult result;
  result.corrections.resize(1);
  check_thrusters(std::span(&recording, 1), one_thruster(), result);
  return result;
}

}  // namespace

TEST_CASE("thruster check: a wrench that the curve makes is left alone, and the commands are used") {
  const ConsistencyResult result = checked(driven(1.0, 0.0));
  CHECK(result.findings.empty());
  CHECK(result.corrections[0].thrusters.use_commands);
  CHECK(result.corrections[0].thrusters.scale == 1.0);
}

TEST_CASE("thruster check: a factor and a voltage are found with their size") {
  const ConsistencyResult larger = checked(driven(1.2, 0.0));
  const ConsistencyFinding* scale = find(larger.findings, "thrusters.tau", "scale");
  REQUIRE(scale != nullptr);
  CHECK(scale->size == doctest::Approx(1.2).epsilon(1e-3));
  const ConsistencyResult sagging = checked(driven(1.0, 1.5));
  const ConsistencyFinding* voltage = find(sagging.findings, "thrusters.tau", "voltage");
  REQUIRE(voltage != nullptr);
  CHECK(voltage->size == doctest::Approx(1.5).epsilon(0.01));
  CHECK(sagging.corrections[0].thrusters.exponent == doctest::Approx(1.5).epsilon(0.01));
}

TEST_CASE("thruster check: where the curve explains nothing, the logged wrench is used") {
  const ConsistencyResult result = checked(driven(1.0, 0.0, false));
  CHECK(find(result.findings, "thrusters.tau", "disagreement") != nullptr);
  CHECK_FALSE(result.corrections[0].thrusters.use_commands);
}

TEST_CASE("thruster check: a thruster that pushes the other way is named") {
  model::Vehicle vehicle = one_thruster();
  vehicle.thrusters.resize(2);
  vehicle.thrusters[0].name = "port";
  vehicle.thrusters[1].name = "starboard";
  vehicle.allocation = Eigen::MatrixXd::Zero(6, 2);
  vehicle.allocation.row(0) << 1.0, 1.0;
  vehicle.allocation.row(5) << 0.4, -0.4;
  Recording recording;
  for (int i = 0; i < 2000; ++i) {
    const double port = 20.0 * std::sin(0.07 * i), starboard = 15.0 * std::sin(0.031 * i + 1.0);
    Thrusters one;
    one.utime = utime_after(0, 0.1 * i);
    one.pwm_us = {1500.0 + 10.0 * port, 1500.0 + 10.0 * starboard};
    one.has_tau = true;
    one.tau[0] = port - starboard;
    one.tau[5] = 0.4 * (port + starboard);
    recording.thrusters.push_back(one);
  }
  ConsistencyResult result;
  result.corrections.resize(1);
  check_thrusters(std::span(&recording, 1), vehicle, result);
  const ConsistencyFinding* sign = find(result.findings, "thrusters.tau", "sign");
  REQUIRE(sign != nullptr);
  CHECK(sign->evidence.ends_with("with starboard reversed"));
  CHECK(sign->action.find("pwm_sign: -1, of starboard") != std::string::npos);
  CHECK(find(result.findings, "thrusters.tau", "disagreement") == nullptr);
  CHECK_FALSE(result.corrections[0].thrusters.use_commands);
}

TEST_CASE("thruster check: pulses without a wrench are all there is to use, forces say it themselves") {
  Recording pulses = driven(1.0, 0.0);
  for (Thrusters& one : pulses.thrusters) one.has_tau = false;
  CHECK(checked(pulses).corrections[0].thrusters.use_commands);
  for (Thrusters& one : pulses.thrusters) one.force = {1.0};
  CHECK_FALSE(checked(pulses).corrections[0].thrusters.use_commands);
}

TEST_CASE("thruster clock: thrusters go to the pose's clock, the others are moved onto it, and it is said") {
  ConsistencyResult result;
  result.corrections.resize(1);
  result.corrections[0].gyro.delay = 0.08;
  result.corrections[0].dvl.delay = 0.02;
  result.corrections[0].pose_shift = 0.08;
  result.findings.push_back({.run = "all", .signal = "thrusters", .finding = "clock", .evidence = "the gyro's"});
  result.findings.push_back({.run = "all", .signal = "gyro", .finding = "delay", .evidence = "late"});
  put_thrusters_on_pose_clock(result);
  CHECK(result.corrections[0].pose_shift == 0.0);
  CHECK(result.corrections[0].gyro_shift == -0.08);
  CHECK(result.corrections[0].dvl_shift == -0.02);
  CHECK(result.findings[0].evidence.find("on that of the pose") != std::string::npos);
  CHECK(result.findings[1].evidence == "late");
}

}  // namespace fathom::consistency

// Effects between the command and the water, against hand-written formulas.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/model/onset.hpp"
#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kThrustersRounding = 1e-12;

struct Fixture {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Motion motion;
  model::Scene scene{.vehicle = &vehicle, .attitude = true, .velocity = true, .rates = true, .t_high = 100.0};

  Fixture() {
    motion.vehicle = &vehicle;
    motion.force = Eigen::Vector4d(16.0, -16.0, 9.0, 4.0);
    scene.force_rms = Eigen::Vector4d(5.0, 5.0, 5.0, 5.0);
    scene.nu_rms.setConstant(0.3);
    scene.tau_rms.setConstant(5.0);
  }
  [[nodiscard]] model::ActuatorForces felt(const char* name, std::vector<double> theta, int variant = 0) const {
    model::Motion copy = motion;
    model::find_effect(name)->feel(copy, theta, variant, {});
    return copy.force;
  }
};

}  // namespace

TEST_CASE("thruster_failure: all before the moment, the rest after it, half at it, one thruster only") {
  Fixture fixture;
  const std::vector<double> theta{0.4, 50.0};
  fixture.motion.t = 49.0;
  CHECK(fixture.felt("thruster_failure", theta, 1) == fixture.motion.force);
  fixture.motion.t = 50.0;
  CHECK(fixture.felt("thruster_failure", theta, 1)[1] == doctest::Approx(-16.0 * 0.8));
  fixture.motion.t = 51.0;
  const model::ActuatorForces after = fixture.felt("thruster_failure", theta, 1);
  CHECK(after[1] == doctest::Approx(-16.0 * 0.6));
  CHECK(after[0] == 16.0);
  CHECK(after[2] == 9.0);
}

TEST_CASE("thruster_failure: one form per thruster that was used, moments across the run, none for a wrench") {
  Fixture fixture;
  fixture.scene.force_rms[3] = 0.0;
  const model::Effect& effect = *model::find_effect("thruster_failure");
  CHECK(effect.variants(fixture.scene) == std::vector<std::string>{"port", "starboard", "vertical", "-"});
  for (const auto& start : effect.starts(fixture.scene, 0)) {
    CHECK(start[1] > 0.0);
    CHECK(start[1] < 100.0);
  }
  fixture.scene.input_is_wrench = true;
  CHECK(effect.variants(fixture.scene).empty());
}

TEST_CASE("onset: rises from nothing to all within its duration, with two continuous derivatives") {
  constexpr double kLast = model::kOnsetDuration, kStep = 1e-3;  // the step in durations
  constexpr double kSmall = 0.1;  // the third derivative is at most 60 per duration cubed
  CHECK(model::onset_share(10.0 - 0.5 * kLast, 10.0) == 0.0);
  CHECK(model::onset_share(10.0, 10.0) == doctest::Approx(0.5));
  CHECK(model::onset_share(10.0 + 0.5001 * kLast, 10.0) == 1.0);
  double last_slope = 0.0, last_bend = 0.0;
  for (double s = -0.6; s < 0.6; s += kStep) {
    const auto share = [](double durations) { return model::onset_share(10.0 + kLast * durations, 10.0); };
    const double slope = (share(s + kStep) - share(s)) / kStep;
    const double bend = (slope - last_slope) / kStep;
    CHECK(slope >= 0.0);
    CHECK(std::abs(bend - last_bend) < kSmall);
    last_slope = slope;
    last_bend = bend;
  }
}

TEST_CASE("thruster_misalignment: a turned thruster pushes along its new axis at its old place") {
  Fixture fixture;
  const model::Effect& effect = *model::find_effect("thruster_misalignment");
  constexpr double kAngle = 0.2;
  constexpr int kStarboardAboutZ = 6 + 2;
  const Eigen::Vector3d before = -16.0 * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d after = -16.0 * Eigen::Vector3d{std::cos(kAngle), std::sin(kAngle), 0.0};
  model::Load load;
  effect.load(fixture.motion, std::vector{kAngle}, kStarboardAboutZ, load);
  const Eigen::Vector3d p{-0.135, 0.0475, 0.0};
  CHECK((load.wrench.head<3>() - (after - before)).norm() < kThrustersRounding);
  CHECK((load.wrench.tail<3>() - p.cross(after - before)).norm() < kThrustersRounding);
  // An allocation knows moments, not places: without one, a thruster sits where its arm is shortest.
  for (model::Thruster& thruster : fixture.vehicle.thrusters) thruster.p_BJ.setZero();
  model::Load unplaced;
  effect.load(fixture.motion, std::vector{kAngle}, kStarboardAboutZ, unplaced);
  const Eigen::Vector3d shortest{0.0, 0.0475, 0.0};
  CHECK((unplaced.wrench.head<3>() - (after - before)).norm() < kThrustersRounding);
  CHECK((unplaced.wrench.tail<3>() - shortest.cross(after - before)).norm() < kThrustersRounding);
}

TEST_CASE("thruster_misalignment: a shifted thruster turns the vehicle by force times shift") {
  const Fixture fixture;
  constexpr int kPortAlongY = 4;
  model::Load load;
  model::find_effect("thruster_misalignment")->load(fixture.motion, std::vector{0.02}, kPortAlongY, load);
  CHECK(load.wrench.head<5>().norm() < kThrustersRounding);
  CHECK(load.wrench[5] == doctest::Approx(-0.02 * 16.0));  // to starboard of the middle, pushing ahead turns to port
}

TEST_CASE("thruster_misalignment: forms that this vehicle cannot feel are not asked for") {
  const Fixture fixture;
  const auto names = model::find_effect("thruster_misalignment")->variants(fixture.scene);
  REQUIRE(names.size() == 24);
  CHECK(names[0] == "-");  // turned about its own axis
  CHECK(names[1] == "port turned about y");
  CHECK(names[2] == "port turned about z");
  CHECK(names[3] == "-");  // shifted along its own axis
  CHECK(names[4] == "port shifted along y");
  CHECK(names[5] == "-");   // pitch, which is not free
  CHECK(names[15] == "-");  // the vertical thruster's arms: roll and pitch
  CHECK(names[16] == "-");
}

TEST_CASE("thruster_delay: vertical thrusters have a time of their own, and none is none") {
  Fixture fixture;
  constexpr int kTwoKinds = 1;
  CHECK(model::find_effect("thruster_delay")->variants(fixture.scene).at(kTwoKinds) == "vertical thrusters apart");
  std::vector<Eigen::VectorXd> ramp;
  for (int k = 0; k <= 100; ++k) ramp.emplace_back(Eigen::VectorXd::Constant(4, 0.1 * k));  // 1 N/s
  const model::InputSignal input{0.0, 0.1, ramp};
  fixture.motion.input = &input;
  fixture.motion.t = 5.0;
  fixture.motion.force.setConstant(4, 5.0);
  const Eigen::Vector4d apart = fixture.felt("thruster_delay", {0.15, 0.2}, kTwoKinds);  // the third pushes down
  CHECK((apart - Eigen::Vector4d{4.85, 4.85, 4.65, 4.85}).norm() < kThrustersRounding * 10);
  const Eigen::Vector4d sooner = fixture.felt("thruster_delay", {0.15, -0.15}, kTwoKinds);
  CHECK((sooner - Eigen::Vector4d{4.85, 4.85, 5.0, 4.85}).norm() < 0.004);  // a hundredth of a second, at most
  CHECK(fixture.felt("thruster_delay", {0.15, 0.0}, kTwoKinds) == fixture.felt("thruster_delay", {0.15, 0.0}, 0));
  CHECK(fixture.felt("thruster_delay", {0.0, 0.0}, kTwoKinds) == fixture.motion.force);
}

/// Thrust of the fixture's craft `steps` of `dt` after the command went from one value to another and stayed there.
model::ActuatorForces lagging(const Fixture& fixture, double from, double to, std::vector<double> theta, int form,
                              double dt, int steps) {
  const model::Effect& effect = *model::find_effect("thruster_lag");
  model::Motion motion = fixture.motion;
  std::vector<double> z(static_cast<std::size_t>(effect.state_size(fixture.vehicle, 4)));
  motion.force.setConstant(4, from);
  effect.settle(motion, theta, form, z);
  motion.force.setConstant(4, to);
  for (int k = 0; k < steps; ++k) effect.advance(motion, theta, form, dt, z);
  effect.feel(motion, theta, form, z);
  return motion.force;
}

TEST_CASE("thruster_lag: after a step each form follows its own exponential, whatever the steps in time") {
  enum Form { kAlike, kTwoKinds, kShaft, kSecondOrder };
  const Fixture fixture;
  const auto after = [&](double from, double to, std::vector<double> theta, int form, double dt) {
    return lagging(fixture, from, to, std::move(theta), form, dt, 12);
  };
  for (const double dt : {0.01, 0.05, 0.5}) {
    CAPTURE(dt);
    const double t = 12.0 * dt, e = std::exp(-t / 0.3), slower = std::exp(-t / 0.8), quicker = std::exp(-t / 0.1);
    CHECK(after(0.0, 9.0, {0.3, 0.0}, kAlike, dt)[1] == doctest::Approx(9.0 * (1.0 - e)));
    const model::ActuatorForces apart = after(4.0, 9.0, {0.3, 0.5}, kTwoKinds, dt);
    CHECK(apart[0] == doctest::Approx(9.0 - 5.0 * e));
    CHECK(apart[2] == doctest::Approx(9.0 - 5.0 * slower));
    CHECK(after(4.0, 9.0, {0.3, -0.2}, kTwoKinds, dt)[2] == doctest::Approx(9.0 - 5.0 * quicker));
    const double rising = 3.0 * (1.0 - e), falling = 3.0 * e, turning = -2.0 + 5.0 * e;
    CHECK(after(0.0, 9.0, {0.3, 0.0}, kShaft, dt)[1] == doctest::Approx(rising * rising));
    CHECK(after(9.0, 0.0, {0.3, 0.0}, kShaft, dt)[1] == doctest::Approx(falling * falling));
    CHECK(after(9.0, -4.0, {0.3, 0.0}, kShaft, dt)[2] == doctest::Approx(turning * std::abs(turning)));
    CHECK(after(4.0, 9.0, {0.3, 0.0}, kSecondOrder, dt)[2] == doctest::Approx(9.0 - 5.0 * (1.0 + t / 0.3) * e));
  }
}

TEST_CASE("thruster_lag: a shaft moved by torque goes as its equation says, whatever the steps in time") {
  constexpr int kTorque = 4;
  Fixture fixture;
  fixture.vehicle.largest_thrust = 16.0;
  constexpr double kTimeConstant = 0.3, kTime = 0.6;
  const auto integrated = [&](double from, double to) {
    constexpr int kSteps = 60000;
    double n = std::copysign(std::sqrt(std::abs(from)), from);
    for (int k = 0; k < kSteps; ++k)
      n += kTime / kSteps * (to - n * std::abs(n)) / (2.0 * std::sqrt(16.0) * kTimeConstant);
    return n * std::abs(n);
  };
  struct Step {
    double from, to;
  };
  for (const Step& step : {Step{0.0, 9.0}, {9.0, 0.0}, {4.0, 9.0}, {9.0, 4.0}, {9.0, -4.0}, {-1.0, 16.0}, {5.0, 5.0}}) {
    CAPTURE(step.from);
    CAPTURE(step.to);
    for (const int parts : {1, 7, 60}) {
      const auto thrust = lagging(fixture, step.from, step.to, {kTimeConstant, 0.0}, kTorque, kTime / parts, parts);
      CHECK(thrust[1] == doctest::Approx(integrated(step.from, step.to)).epsilon(1e-4));  // Euler's error
    }
  }
  // Near the largest thrust it is the time constant of a first-order lag.
  const double near = lagging(fixture, 16.0, 15.9, {kTimeConstant, 0.0}, kTorque, kTimeConstant, 1)[0];
  CHECK(near == doctest::Approx(16.0 - 0.1 * (1.0 - std::exp(-1.0))).epsilon(1e-5));
  CHECK(lagging(fixture, 9.0, -4.0, {0.0, 0.0}, kTorque, 0.1, 1)[0] == -4.0);
}

TEST_CASE("thruster_lag, thruster_delay: forms that these thrusters cannot tell apart are not asked for") {
  Fixture fixture;
  const auto names = [&](const char* effect) { return model::find_effect(effect)->variants(fixture.scene); };
  CHECK(names("thruster_lag") ==
        std::vector<std::string>{"", "vertical thrusters apart", "shaft speed", "second order", "torque"});
  fixture.vehicle.thrusters.erase(fixture.vehicle.thrusters.begin() + 2);
  model::Allocation level(6, 3);
  level << fixture.vehicle.allocation.leftCols(2), fixture.vehicle.allocation.rightCols(1);
  fixture.vehicle.allocation = level;
  fixture.scene.force_rms = Eigen::Vector3d::Constant(5.0);
  CHECK(names("thruster_lag") == std::vector<std::string>{"", "-", "shaft speed", "second order", "torque"});
  CHECK(names("thruster_delay") == std::vector<std::string>{"", "-"});
  fixture.scene.force_rms = Vector6d::Constant(5.0);
  fixture.scene.input_is_wrench = true;
  CHECK(names("thruster_lag") == std::vector<std::string>{"", "vertical thrusters apart", "-", "second order", "-"});
}

TEST_CASE("thrust_loss: bilinear in shaft speed and advance, in both directions") {
  Fixture fixture;
  fixture.motion.nu[0] = 0.5;
  CHECK(fixture.felt("thrust_loss", {0.8}, 0)[0] == doctest::Approx(16.0 - 0.8 * 4.0 * 0.5));
  CHECK(fixture.felt("thrust_loss", {0.1}, 1)[0] == doctest::Approx(16.0 - 0.1 * 16.0 * 0.5));
  CHECK(fixture.felt("thrust_loss", {0.8}, 2) == fixture.felt("thrust_loss", {0.8}, 0));
  CHECK(fixture.felt("thrust_loss", {0.1}, 3) == fixture.felt("thrust_loss", {0.1}, 1));
  CHECK(fixture.felt("thrust_loss", {0.8}, 0)[1] == doctest::Approx(-16.0 - 0.8 * 4.0 * 0.5));  // crash stop gains
  fixture.motion.nu[0] = -0.5;
  CHECK(fixture.felt("thrust_loss", {0.8}, 0)[1] == doctest::Approx(-16.0 + 0.8 * 4.0 * 0.5));
  fixture.motion.nu[0] = 0.0;
  CHECK(fixture.felt("thrust_loss", {0.8}, 0) == fixture.motion.force);
}

TEST_CASE("thrust_loss: turning moves the thrusters too, and water that moves along takes nothing") {
  Fixture fixture;
  fixture.motion.nu[5] = 1.0;
  // The port thruster, 4.75 cm to port, is carried ahead when the bow turns to starboard.
  CHECK(fixture.felt("thrust_loss", {0.8}, 0)[0] == doctest::Approx(16.0 - 0.8 * 4.0 * 0.0475));
  for (const int of_hull : {2, 3}) CHECK(fixture.felt("thrust_loss", {0.8}, of_hull) == fixture.motion.force);
  fixture.motion.nu << 0.4, 0.0, 0.0, 0.0, 0.0, 0.0;
  fixture.motion.v_WF_B.x() = 0.4;
  CHECK(fixture.felt("thrust_loss", {0.8}, 0) == fixture.motion.force);
}

TEST_CASE("thrust_loss: a wrench loses force along its axes, and no moment") {
  Fixture fixture;
  fixture.motion.force = Vector6d::Constant(4.0);
  fixture.motion.nu.setConstant(0.5);
  const model::ActuatorForces felt = fixture.felt("thrust_loss", {1.0}, 0);
  for (Eigen::Index i = 0; i < 3; ++i) CHECK(felt[i] == doctest::Approx(3.0));
  for (Eigen::Index i = 3; i < 6; ++i) CHECK(felt[i] == 4.0);
}

TEST_CASE("battery_sag: by voltage where it says something, by time where it is not logged or does not change") {
  Fixture fixture;
  const model::Effect& effect = *model::find_effect("battery_sag");
  CHECK(effect.variants(fixture.scene) == std::vector<std::string>{"-", "loss per 300 s"});
  fixture.scene.voltage = true;
  fixture.scene.mean_voltage = 15.0;
  CHECK(effect.variants(fixture.scene) == std::vector<std::string>{"-", "loss per 300 s"});
  fixture.scene.voltage_range = 2.0;
  CHECK(effect.variants(fixture.scene) == std::vector<std::string>{"voltage exponent", "-"});
  fixture.motion.t = 150.0;
  CHECK(fixture.felt("battery_sag", {0.4}, 1)[0] == doctest::Approx(16.0 * 0.8));
  fixture.motion.voltage = 8.0;
  fixture.vehicle.nominal_voltage = 16.0;
  CHECK(fixture.felt("battery_sag", {2.0}, 0)[0] == doctest::Approx(4.0));
  fixture.motion.voltage = 0.0;  // a gap in the log
  CHECK(fixture.felt("battery_sag", {2.0}, 0)[0] == 16.0);
}

TEST_CASE("thruster_deadband: a rounded band takes all but a trace of small commands and nothing beyond its width") {
  Fixture fixture;
  const auto share = [&](double command, double width) {
    fixture.motion.force.setConstant(command);
    return fixture.felt("thruster_deadband", {width}, 2)[0] / command;
  };
  CHECK(share(1.0, 2.0) == doctest::Approx(0.5));
  CHECK(share(-1.0, 2.0) == doctest::Approx(0.5));
  CHECK(share(0.1, 2.0) == doctest::Approx(0.00725));
  CHECK(share(2.0, 2.0) == 1.0);
  CHECK(share(-4.0, 2.0) == 1.0);
}

TEST_CASE("thruster_deadband: a search for the step begins close to wherever its edge may be") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Scene scene{.vehicle = &vehicle};
  scene.force_rms = model::ActuatorForces::Constant(4, 5.0);
  constexpr int kStep = 1;
  const auto starts = model::find_effect("thruster_deadband")->starts(scene, kStep);
  // A constant command, as a trim, is often close to the edge, and no slope leads past it.
  for (double edge = 0.25; edge < 4.0; edge *= 1.01) {
    CHECK(std::ranges::any_of(starts, [&](const auto& start) { return start[0] > edge && start[0] < 1.2 * edge; }));
  }
}

TEST_CASE("thruster_deadband: a command that passes edges of the step within a sample pushes as the sharp step does") {
  constexpr int kStep = 1, kSamples = 200, kFine = 400;
  constexpr double kEdge = 1.3, kDt = 0.01, kShare = 0.01;  // of the edge: the sum over parts of a sample is no better
  Fixture fixture;
  for (const double slope : {3.0, 40.0, -25.0, 900.0, -700.0}) {  // N/s; the last two pass both edges at once
    CAPTURE(slope);
    const auto command = [&](double t) { return slope * (t - 0.9773); };
    std::vector<Eigen::VectorXd> commands;
    for (int k = 0; k < kSamples; ++k) commands.emplace_back(Eigen::VectorXd::Constant(4, command(k * kDt)));
    const model::InputSignal input{0.0, kDt, commands};
    fixture.motion.input = &input;
    double worst = 0.0;
    for (int k = 0; k + 1 < kSamples; ++k) {
      fixture.motion.t = (k + 0.5) * kDt;
      input.now(fixture.motion.t, fixture.motion.force);
      double sharp = 0.0;
      for (int i = 0; i < kFine; ++i) {
        const double now = command((k + (i + 0.5) / kFine) * kDt);
        sharp += std::abs(now) > kEdge ? now / kFine : 0.0;
      }
      worst = std::max(worst, std::abs(fixture.felt("thruster_deadband", {kEdge}, kStep)[0] - sharp));
    }
    CHECK(worst < kShare * kEdge);
  }
}

TEST_CASE("thruster_deadband: what a delayed command pushes does not hang on what is told meanwhile") {
  constexpr int kStep = 1;
  Fixture fixture;
  const std::vector<Eigen::VectorXd> jump{Eigen::VectorXd::Constant(4, 1.0), Eigen::VectorXd::Constant(4, 9.0)};
  const model::InputSignal input{0.0, 0.01, jump};
  fixture.motion.input = &input;
  fixture.motion.t = 0.005;  // told is 5 N on its way; what was told before still acts
  fixture.motion.force.setConstant(1.0);
  CHECK(fixture.felt("thruster_deadband", {1.3}, kStep)[0] == 0.0);
  fixture.motion.force.setConstant(2.0);
  CHECK(fixture.felt("thruster_deadband", {1.3}, kStep)[0] == doctest::Approx(2.0));
}

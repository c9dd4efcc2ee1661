// Propellers by shaft speed, rudders and azimuth thrusters, against hand-computed numbers.
#include "common/model/actuators.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "common/base/error.hpp"
#include "common/model/dynamics.hpp"
#include "test/support/scratch.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::model {
namespace {

constexpr double kTypedRounding = 1e-9;  // relative: powers and roots of a few products

Vehicle with_actuators(const std::string& lines, const std::string& dof = "dof: [surge, sway, yaw]") {
  const test::Scratch scratch;
  const std::string path = scratch.path("craft.yaml");
  test::write_bytes(path, "name: Craft\n" + dof + "\nmass: 100 kg\nwater_density: 1000 kg/m^3\n" + lines);
  return Vehicle::load(path);
}

std::string refused(const std::string& lines, const std::string& dof = "dof: [surge, sway, yaw]") {
  try {
    static_cast<void>(with_actuators(lines, dof));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

const std::string kPropeller =
    "actuators:\n  - {name: screw, kind: propeller, position: -1 0 0 m, axis: 1 0 0, diameter: 0.2 m, K_T0: 0.4, "
    "K_TJ: -0.5, astern: 0.6}\n";
const std::string kRudder =
    "  - {name: rudder, kind: rudder, position: -1.2 0 0 m, axis: 0 1 0, area: 0.02 m^2, lift_slope: 2.5 1/rad, stall: "
    "30 deg, reference_speed: 2 m/s, behind: screw, slipstream_diameter: 0.2 m, slipstream_share: 0.5}\n";

}  // namespace

TEST_CASE("actuators: a propeller gives rho D^4 K_T n |n| + rho D^3 K_TJ |n| u_a") {
  const Vehicle craft = with_actuators(kPropeller);
  const double n = 8.0, D = 0.2, rho = 1000.0;  // rev/s, m, kg/m^3
  const double still = rho * std::pow(D, 4) * 0.4 * n * n;
  const double omega = n * 2.0 * std::numbers::pi;
  CHECK(forces_of_commands(craft, std::vector{omega}, 0.0)[0] == doctest::Approx(still).epsilon(kTypedRounding));
  CHECK(forces_of_commands(craft, std::vector{-omega}, 0.0)[0] ==
        doctest::Approx(-0.6 * still).epsilon(kTypedRounding));
  Motion motion{.vehicle = &craft};
  motion.nu[0] = 1.5;
  motion.force = ActuatorForces::Constant(1, still);
  CHECK(acting_force(craft, motion, 0) ==
        doctest::Approx(still - rho * std::pow(D, 3) * 0.5 * n * 1.5).epsilon(kTypedRounding));
  motion.nu.setZero();
  CHECK(acting_force(craft, motion, 0) == still);
}

TEST_CASE("actuators: a rudder's force grows with the square of the speed past it, and stalls") {
  const Vehicle craft = with_actuators(kPropeller + kRudder);
  const double angle = 0.2, full = 0.5 * 1000.0 * 0.02 * 2.5 * 4.0;  // N/rad at 2 m/s
  const std::vector<double> force = forces_of_commands(craft, std::vector{0.0, angle}, 0.0);
  CHECK(force[1] == doctest::Approx(full * angle).epsilon(kTypedRounding));
  CHECK(forces_of_commands(craft, std::vector{0.0, 1.0}, 0.0)[1] ==
        doctest::Approx(full * std::numbers::pi / 6.0).epsilon(kTypedRounding));
  Motion motion{.vehicle = &craft};
  motion.force = Eigen::Vector2d(0.0, force[1]);
  CHECK(acting_force(craft, motion, 1) == 0.0);  // no water passes
  motion.nu[0] = 2.0;
  CHECK(acting_force(craft, motion, 1) == doctest::Approx(force[1]).epsilon(kTypedRounding));
  motion.nu[0] = 1.0;
  CHECK(acting_force(craft, motion, 1) == doctest::Approx(0.25 * force[1]).epsilon(kTypedRounding));
  motion.nu[0] = -1.0;  // astern it pushes the other way
  CHECK(acting_force(craft, motion, 1) == doctest::Approx(-0.25 * force[1]).epsilon(kTypedRounding));
}

TEST_CASE("actuators: at rest a rudder works in its propeller's slipstream, V^2 = 2 f / (rho A)") {
  const Vehicle craft = with_actuators(kPropeller + kRudder);
  Motion motion{.vehicle = &craft};
  motion.force = Eigen::Vector2d(50.0, 30.0);
  const double jet = 2.0 * 50.0 / (1000.0 * std::numbers::pi * 0.1 * 0.1);
  CHECK(acting_force(craft, motion, 1) == doctest::Approx(30.0 * 0.5 * jet / 4.0).epsilon(kTypedRounding));
  motion.nu[0] = 1.0;  // a propeller that advances gives less, and so does its jet
  const double less = 2.0 * acting_force(craft, motion, 0) / (1000.0 * std::numbers::pi * 0.1 * 0.1);
  CHECK(less < 0.9 * jet);
  CHECK(acting_force(craft, motion, 1) == doctest::Approx(30.0 * (1.0 + 0.5 * less) / 4.0).epsilon(kTypedRounding));
  motion.nu[0] = 0.0;
  motion.force[0] = -50.0;  // a propeller that goes astern sends its wash away from the rudder
  CHECK(acting_force(craft, motion, 1) == 0.0);
  const Model model = nominal_model(craft, false);
  motion.force[0] = 50.0;
  Load load;
  const Vector6d tau = generalised_force(model, motion, load);
  CHECK(tau[5] == doctest::Approx(-1.2 * tau[1]).epsilon(kTypedRounding));
  // Driven by a wrench, the same craft takes it as it is.
  const Model by_wrench = nominal_model(craft, true);
  motion.force = ActuatorForces::Zero(6);
  motion.force[1] = 7.0;
  CHECK(generalised_force(by_wrench, motion, load)[1] == 7.0);
}

TEST_CASE("actuators: an azimuth thruster is a force and an angle, and two columns") {
  const Vehicle craft = with_actuators("actuators:\n  - {name: pod, kind: azimuth, position: -1 0.5 0 m}\n");
  REQUIRE(craft.thrusters.size() == 2);
  const std::vector<double> force = forces_of_commands(craft, std::vector{10.0, std::numbers::pi / 6.0}, 0.0);
  CHECK(force[0] == doctest::Approx(10.0 * std::sqrt(0.75)).epsilon(kTypedRounding));
  CHECK(force[1] == doctest::Approx(5.0).epsilon(kTypedRounding));
  const Vector6d tau = craft.allocation * Eigen::Vector2d(force[0], force[1]);
  CHECK(tau[5] == doctest::Approx(-1.0 * force[1] - 0.5 * force[0]).epsilon(kTypedRounding));
}

TEST_CASE(
    "actuators: a buoyancy engine pulls along the world's down at its place, a moving mass turns the hull by its "
    "weight") {
  const Vehicle glider = with_actuators(
      "actuators:\n  - {name: engine, kind: buoyancy_engine, position: 0.7 0 0 m}\n"
      "  - {name: tank, kind: ballast_tank, position: 0 0.2 0 m}\n"
      "  - {name: battery, kind: moving_mass, axis: 1 0 0, mass: 9 kg}\n"
      "  - {name: roller, kind: turning_mass, axis: 1 0 0, mass: 10 kg, radius: 0.03 m}\n",
      "dof: [surge, sway, heave, roll, pitch, yaw]");
  const double g = 9.80665, pitch = 0.4;
  const std::vector<double> commands{250e-6, 0.5, 0.02, std::numbers::pi / 6.0};  // m^3 out, kg in, m ahead, rad
  const std::vector<double> force = forces_of_commands(glider, commands, 0.0);
  CHECK(force[0] == doctest::Approx(-1000.0 * g * 250e-6).epsilon(kTypedRounding));  // lighter: up
  CHECK(force[1] == doctest::Approx(0.5 * g).epsilon(kTypedRounding));
  CHECK(force[2] == doctest::Approx(9.0 * g * 0.02).epsilon(kTypedRounding));
  CHECK(force[3] == doctest::Approx(10.0 * g * 0.03 * 0.5).epsilon(kTypedRounding));
  Motion motion{.vehicle = &glider};
  motion.force = Eigen::Map<const Eigen::VectorXd>(force.data(), 4);
  // Nose up by `pitch`: down is (-sin, 0, cos) in the body.
  motion.R_WB = Eigen::AngleAxisd{pitch, Eigen::Vector3d::UnitY()}.toRotationMatrix();
  const double s = std::sin(pitch), c = std::cos(pitch);
  Vector6d engine, tank, battery, roller;
  engine << -force[0] * s, 0.0, force[0] * c, 0.0, -0.7 * force[0] * c, 0.0;
  // Weight (-s, 0, c) W at (0, 0.2, 0): K = 0.2 c W, N = 0.2 s W.
  tank << -force[1] * s, 0.0, force[1] * c, 0.2 * force[1] * c, 0.0, 0.2 * force[1] * s;
  // Weight at (x, 0, 0): M = -x c W, nose down as the mass goes ahead.
  battery << 0.0, 0.0, 0.0, 0.0, -force[2] * c, 0.0;
  // From (0, 0, r) to (0, -r sin 30, r cos 30): moved by (0, -r/2, r (cos 30 - 1)).
  const double y = -force[3], z = 10.0 * g * 0.03 * (std::sqrt(0.75) - 1.0);
  roller << 0.0, 0.0, 0.0, y * c, -z * s, y * s;
  const Vector6d expected[] = {engine, tank, battery, roller};
  for (Eigen::Index i = 0; i < 4; ++i) {
    CAPTURE(i);
    CHECK((acting_wrench(glider, motion, i) - expected[i]).norm() < kTypedRounding);
  }
  Load load;
  const Model model = nominal_model(glider, false);
  Motion idle = motion;
  idle.force.setZero();
  const Vector6d tau = generalised_force(model, motion, load) - generalised_force(model, idle, load);
  CHECK((tau - engine - tank - battery - roller).norm() < 1e-9);
  // Level, all of it is the allocation, which screenings and wirings go by.
  motion.R_WB.setIdentity();
  motion.force[3] = 0.0;  // what a turning mass loses in depth is not in it
  Vector6d level = Vector6d::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) level += acting_wrench(glider, motion, i);
  CHECK((level - glider.allocation * motion.force).norm() < kTypedRounding);
}

TEST_CASE("actuators: bad lines are refused by name") {
  CHECK(refused("actuators:\n  - {name: a, kind: moving_mass, axis: 0 0 1, mass: 9 kg}\n").find("straight up") !=
        std::string::npos);
  CHECK(refused("actuators:\n  - {name: a, kind: moving_mass, position: 0 0 0 m, axis: 1 0 0, mass: 9 kg}\n",
                "dof: [surge, heave, pitch]")
            .find("position") != std::string::npos);
  CHECK(refused("actuators:\n  - {name: a, kind: moving_mass, axis: 1 0 0, mass: 9 kg}\n").find("push along none") !=
        std::string::npos);
  CHECK(refused("actuators:\n  - {name: a, kind: turning_mass, axis: 0 0 1, mass: 9 kg, radius: 1 cm}\n")
            .find("must be level") != std::string::npos);
  CHECK(refused("actuators:\n  - {name: a, kind: sail, position: 0 0 0 m, axis: 1 0 0}\n").find("is no actuator") !=
        std::string::npos);
  CHECK(refused("thrusters:\n  - {name: b, position: 0 0 0 m, axis: 1 0 0}\n" + kPropeller).find("not both") !=
        std::string::npos);
  CHECK(refused("actuators:\n" + kRudder).find("list a propeller before") != std::string::npos);
  CHECK(refused(kPropeller + kPropeller.substr(kPropeller.find("  -"))).find("two actuators") != std::string::npos);
}

TEST_CASE("actuators: thrusters of today's files are none of it") {
  const Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  CHECK_FALSE(vehicle.flow_matters);
  CHECK_FALSE(nominal_model(vehicle, false).motion_matters);
  const Vehicle launch = test::vehicle_from_repository("twin_screw_launch");
  CHECK(launch.flow_matters);
  CHECK(takes_commands(launch));
  CHECK(launch.thrusters.size() == 4);
}

}  // namespace fathom::model

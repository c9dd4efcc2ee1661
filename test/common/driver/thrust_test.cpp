// What reaches the thrusters: allocation by the vehicle file, and the gate that lets a command pass.
#include <doctest/doctest.h>

#include "common/base/error.hpp"
#include "common/driver/allocation.hpp"
#include "common/driver/thruster_gate.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;
using namespace fathom::driver;

namespace {

constexpr Utime kStart = 1'700'000'000'000'000;
constexpr double kCurve = 1e-9;  // the curve is piecewise linear in both directions

model::Vehicle vehicle(const std::string& name) {
  return model::Vehicle::load(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/" + name + ".yaml");
}

Utime at(double seconds) { return utime_after(kStart, seconds); }

WrenchCommand surge(double seconds) {
  WrenchCommand command{.utime = at(seconds), .life = 0.5};
  command.tau(0) = 10.0;
  return command;
}

}  // namespace

TEST_CASE("allocation: every controlled degree of freedom gets what was asked, alone and together") {
  for (const char* name : {"bluerov2", "beluga"}) {
    const model::Vehicle subject = vehicle(name);
    const Allocation allocation{subject, 100.0};
    Vector6d tau = Vector6d::Zero();
    for (std::size_t i = 0; i < 6; ++i) {
      if (!subject.dof[i]) continue;
      const double share = i < 3 ? 4.0 : 0.3;
      tau(static_cast<Eigen::Index>(i)) = share;
      const Allocated result = allocation.allocate(tau, subject.curve.voltage);
      CAPTURE(name);
      CAPTURE(i);
      CHECK(result.scale == 1.0);
      for (std::size_t k = 0; k < 6; ++k) {
        if (!subject.dof[k]) continue;
        CHECK(std::abs(result.tau(static_cast<Eigen::Index>(k)) - tau(static_cast<Eigen::Index>(k))) < 1e-6);
      }
    }
  }
}

TEST_CASE("allocation: surge of the BlueROV2 by hand") {
  const Allocation allocation{vehicle("bluerov2"), 100.0};
  Vector6d tau = Vector6d::Zero();
  tau(0) = 4.0 * 0.7071 * 8.1;  // four thrusters at 45 degrees; 8.1 N is a corner of the curve, at 1600 us
  const Allocated result = allocation.allocate(tau, 16.0);
  for (std::size_t i = 0; i < 4; ++i) CHECK(result.pwm_us[i] == doctest::Approx(1600.0).epsilon(1e-3));
  for (std::size_t i = 4; i < 6; ++i)
    CHECK(result.pwm_us[i] == 1500.0);  // no force is neutral, not an edge of the plateau
}

TEST_CASE("allocation: beyond the limit all thrusters shrink alike and the direction stays") {
  const Allocation allocation{vehicle("bluerov2"), 5.0};
  Vector6d tau = Vector6d::Zero();
  tau(0) = 100.0;
  tau(5) = 5.0;
  const Allocated result = allocation.allocate(tau, 16.0);
  CHECK(result.scale < 0.3);
  for (const Eigen::Index axis : {0, 1, 2, 3, 5}) {  // pitch is not controlled
    CHECK(std::abs(result.tau(axis) - result.scale * tau(axis)) < 1e-6);
  }
  for (const double force : result.force) CHECK(std::abs(force) <= 5.0 + kCurve);
}

TEST_CASE("allocation: what the vehicle reports gives the wrench that it felt") {
  const Allocation allocation{vehicle("bluerov2"), 100.0};
  Vector6d tau = Vector6d::Zero();
  tau << 5.0, -3.0, 4.0, 0.1, 0.0, 0.5;
  const Allocated sent = allocation.allocate(tau, 16.0);
  const Allocated told = allocation.applied(sent.pwm_us, 16.0);
  CHECK((told.tau - sent.tau).norm() < kCurve);
  CHECK(allocation.neutral().tau.norm() == 0.0);
  model::Vehicle bare = vehicle("bluerov2");
  bare.thrusters.clear();
  CHECK(test::complaint_of<InputError>([&] { Allocation none(bare, 1.0); }).find("thrusters") != std::string::npos);
}

TEST_CASE("gate: no command, no thrust; a command is obeyed until half a second after the last") {
  ThrusterGate gate{at(0.0)};
  CHECK(gate.wrench(at(0.1)).isZero());
  gate.hear(surge(1.0), at(1.0));
  CHECK(gate.wrench(at(1.1))(0) == 10.0);
  CHECK(gate.wrench(at(1.49))(0) == 10.0);
  CHECK(gate.wrench(at(1.51)).isZero());
  CHECK(gate.reason(at(1.51)) == "commands have stopped");
}

TEST_CASE("gate: a short life ends earlier, an old command is refused, numbers that are none are refused") {
  ThrusterGate gate{at(0.0)};
  WrenchCommand command = surge(1.0);
  command.life = 0.1;
  gate.hear(command, at(1.0));
  CHECK(gate.wrench(at(1.05))(0) == 10.0);
  CHECK(gate.wrench(at(1.15)).isZero());
  gate.hear(surge(1.0), at(3.0));
  CHECK(gate.reason(at(3.0)) == "commands are too old");
  command = surge(4.0);
  command.tau(1) = std::nan("");
  gate.hear(command, at(4.0));
  CHECK(gate.wrench(at(4.0)).isZero());
}

TEST_CASE("gate: commands that flow when the driver starts wait for a pause or for the operator") {
  ThrusterGate gate{at(0.0)};
  for (int i = 1; i <= 20; ++i) {
    gate.hear(surge(0.1 * i), at(0.1 * i));
    CHECK(gate.wrench(at(0.1 * i)).isZero());
  }
  SUBCASE("a pause") {
    gate.hear(surge(2.7), at(2.7));
    CHECK(gate.wrench(at(2.7))(0) == 10.0);
  }
  SUBCASE("enable") {
    gate.hear(Operator{.enable = true}, at(2.05));
    gate.hear(surge(2.1), at(2.1));
    CHECK(gate.wrench(at(2.1))(0) == 10.0);
  }
}

TEST_CASE("gate: an abort is at once and holds until enable") {
  ThrusterGate gate{at(0.0)};
  gate.hear(surge(1.0), at(1.0));
  gate.hear(Operator{.abort = true}, at(1.1));
  CHECK(gate.wrench(at(1.1)).isZero());
  gate.hear(surge(1.2), at(1.2));
  CHECK(gate.wrench(at(1.2)).isZero());
  gate.hear(surge(3.0), at(3.0));  // a pause does not end an abort
  CHECK(gate.wrench(at(3.0)).isZero());
  gate.hear(Operator{.enable = true}, at(3.1));
  CHECK(gate.wrench(at(3.1)).isZero());  // nor is the old command taken up again
  gate.hear(surge(3.2), at(3.2));
  CHECK(gate.wrench(at(3.2))(0) == 10.0);
}

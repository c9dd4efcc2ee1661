// The gate that lets a command pass to the thrusters.
#include <doctest/doctest.h>

#include "common/driver/thruster_gate.hpp"

using namespace fathom;
using namespace fathom::driver;

namespace {

constexpr Utime kStart = 1'700'000'000'000'000;

Utime at(double seconds) { return utime_after(kStart, seconds); }

WrenchCommand surge(double seconds) {
  WrenchCommand command{.utime = at(seconds), .life = 0.5};
  command.tau(0) = 10.0;
  return command;
}

}  // namespace

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

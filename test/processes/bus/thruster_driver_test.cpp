// The thruster driver as a process: who may arm it, what it obeys, and how fast it lets go.
#include <doctest/doctest.h>

#include <fstream>

#include "common/link/server.hpp"
#include "test/support/orders.hpp"
#include "test/support/wire_data.hpp"

namespace fathom {
namespace {

using test::Background;
using test::Bus;
using test::program;
using test::Scratch;

}  // namespace

TEST_CASE(
    "thruster_driver: arms by its key alone, obeys, goes to zero within half a second, hears an abort, and says what "
    "was "
    "applied") {
  for (const std::string protocol : {"text", "motor_test", "rc_override", "dry_run"}) {
    CAPTURE(protocol);
    const Scratch scratch;
    Bus bus;
    const bool sticks = protocol == "rc_override";
    std::ofstream{scratch.path("x.yaml")}
        << "thruster_driver:\n  protocol: " << protocol << "\n  rate: 20 Hz\n  largest_thrust: 30 N\n"
        << (protocol == "dry_run" ? "" : "  link: serial://" + scratch.path("tty") + "?baud=115200\n")
        << (sticks ? "  full_stick: {X: 40 N, Y: 40 N, Z: 40 N, K: 4 N m, M: 4 N m, N: 4 N m}\n" : "")
        << (sticks || protocol == "motor_test" ? "  system: 1\n" : "");
    // What the sticks give only a vehicle that allocates can tell.
    const Background rig{
        scratch, "rig",
        sticks
            ? program("simulator") + " --config " + test::file("config/vehicles/bluerov2.yaml") + " --config " +
                  test::file("config/sites/tank.yaml") + " --config " + test::file("config/simulation/bluerov2.yaml") +
                  " --config " + test::file("config/operators/simulated.yaml") + " --bytes " + scratch.path("x.yaml") +
                  " --duration 30 --out-dir " + scratch.path("") + " --in '" + bus.url + "'"
            : program("fathom") + " emulate " + (protocol == "motor_test" ? "mavlink" : "thruster_text") +
                  " --to pty:" + scratch.path("tty")};
    const Background driver{
        scratch, "driver",
        program("thruster_driver") + " --config " + scratch.path("x.yaml") + " --config " +
            test::file(protocol == "text" ? "config/vehicles/beluga.yaml" : "config/vehicles/bluerov2.yaml") +
            " --config " + test::file("config/operators/simulated.yaml") + " --in '" + bus.url + "'"};
    bus.until([&] { return bus.gate() != nullptr && !bus.thrusters.empty(); });
    CAPTURE(test::read_bytes(scratch.path("driver.text")));
    const auto thrust = [&] { return bus.thrusters.empty() ? -1.0 : bus.thrusters.back().tau[0]; };
    CHECK(thrust() == doctest::Approx(0.0));
    test::Commander commander{bus};
    Utime commanded{};
    const auto command = [&](double seconds, double wanted = 1e9) {
      for (int i = 0; i < static_cast<int>(20 * seconds) && thrust() < wanted; ++i) {
        commanded = commander.say(test::ahead(20.0)).utime;
        bus.listen(0.05);
      }
    };
    constexpr double kSlow = 20.0;  // s until a busy machine obeys
    command(0.7);
    CHECK(thrust() == doctest::Approx(0.0));  // nobody has armed
    commander.obey(test::give(bus, {.enable = true}, keys_from(Key{1, 2, 3})));
    command(0.4);
    CHECK(thrust() == doctest::Approx(0.0));
    commander.armed_by = 0;
    const auto order = test::give(bus, {.enable = true});
    command(0.4);
    CHECK(thrust() == doctest::Approx(0.0));  // who was publishing before
    commander.obey(order);
    command(kSlow, 18.0);
    command(0.5);
    CHECK(thrust() == doctest::Approx(20.0).epsilon(0.05));  // the rig rounds to a microsecond
    CHECK(bus.until([&] { return thrust() == doctest::Approx(0.0); }));
    Utime pushed{};
    for (const auto& each : bus.thrusters) {
      if (each.tau[0] != doctest::Approx(0.0)) pushed = each.utime;
    }
    CHECK(seconds_between(commanded, pushed) < 0.9);  // half a second, and the rig's next report
    command(kSlow, 15.0);
    CHECK(thrust() > 15.0);
    const auto abort = test::give(bus, {.sequence = 77, .abort = true});
    const auto answered = [&] {
      return std::ranges::any_of(bus.answers, [&](const auto& each) { return each.sequence == abort.sequence; });
    };
    for (double waited = 0.0; waited < kSlow && !answered(); waited += 0.05) command(0.05);
    CHECK(answered());
    command(0.4);
    REQUIRE(bus.gate() != nullptr);
    CHECK(thrust() == doctest::Approx(0.0));
  }
}

TEST_CASE("thruster_driver: RC override puts the wrench on the pilot's channels, and the middle when commands stop") {
  const Scratch scratch;
  Bus bus;
  link::Server vehicle{"pty:" + scratch.path("tty")};
  std::ofstream{scratch.path("x.yaml")}
      << "thruster_driver:\n  protocol: rc_override\n  rate: 20 Hz\n  largest_thrust: 30 N\n"
      << "  link: serial://" << scratch.path("tty") << "?baud=115200\n  system: 1\n"
      << "  full_stick: {X: 40 N, Y: 40 N, Z: 40 N, K: 4 N m, M: 4 N m, N: 4 N m}\n";
  const Background driver{scratch, "driver",
                          program("thruster_driver") + " --config " + scratch.path("x.yaml") + " --config " +
                              test::file("config/vehicles/bluerov2.yaml") + " --config " +
                              test::file("config/operators/simulated.yaml") + " --in '" + bus.url + "'"};
  REQUIRE(bus.until([&] { return bus.gate() != nullptr; }));
  test::Commander commander{bus};
  commander.obey(test::give(bus, {.enable = true}));
  CHECK(bus.until([&] { return bus.gate()->armed != 0; }));
  (void)vehicle.wait(0.1);
  std::string bytes;
  for (int i = 0; i < 20; ++i) {
    Vector6d tau = test::ahead(10.0);
    tau[2] = 5.0;   // down
    tau[5] = -0.4;  // to port
    commander.say(tau);
    bus.listen(0.05);
    bytes += vehicle.wait(0.0);
  }
  const auto overrides = [](const std::string& stream) {
    const devices::Protocol& protocol = devices::protocol("mavlink", "test");
    const auto parser = protocol.make({});
    std::vector<test::WireRow> found;
    for (test::WireRow& row : test::decode_wire(*parser, protocol, {}, stream)) {
      if (row.at("msgid") == "70") found.push_back(std::move(row));
    }
    return found;
  };
  const auto obeyed = overrides(bytes);
  REQUIRE(obeyed.size() > 10);
  CHECK(obeyed.back().at("f5") == "1600");  // forward: a quarter of 400 us
  CHECK(obeyed.back().at("f3") == "1450");  // throttle is up
  CHECK(obeyed.back().at("f4") == "1460");  // yaw
  CHECK(obeyed.back().at("f6") == "1500");
  CHECK(bytes.find("\xFD\x09") != std::string::npos);  // a ground station's heartbeat of nine bytes
  bus.listen(0.7);
  (void)vehicle.wait(0.0);
  bus.listen(0.3);
  const auto stopped = overrides(vehicle.wait(0.1));
  REQUIRE_FALSE(stopped.empty());
  CHECK(stopped.back().at("f5") == "1500");
  CHECK(stopped.back().at("f3") == "1500");
}

}  // namespace fathom

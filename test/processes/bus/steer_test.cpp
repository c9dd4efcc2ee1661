// Who steers is missed when he lets go, and who armed when he is gone: real programs on a bus of their own.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <linux/joystick.h>
#include <unistd.h>

#include <cmath>

#include "test/support/dry_vehicle.hpp"
#include "test/support/private_network.hpp"

namespace fathom {
namespace {

using test::Background;
using test::file;
using test::give;
using test::now;
using test::program;
using test::Scratch;

const std::string kOperator = test::operator_file();
using Vehicle = test::DryVehicle;

}  // namespace

TEST_CASE("orders: what is steered ages out: one order to push is not held") {
  Vehicle vehicle;
  vehicle.start_supervisor();
  give(vehicle.bus, {.enable = true, .order = "hold"});
  CHECK_MESSAGE(vehicle.until([&] { return vehicle.supervisor_says("hold: "); }), vehicle.bus.said_of("supervisor"));
  give(vehicle.bus, {.order = "manual", .tau = test::ahead(10.0)});
  CHECK(vehicle.until([&] { return vehicle.pushes_ahead(10.0); }));
  vehicle.run(1.0);
  CHECK(std::abs(vehicle.commanded_ahead()) < 1.0);
  CHECK_MESSAGE(vehicle.until([&] { return vehicle.supervisor_says("hold: who steers has let go"); }),
                vehicle.bus.said_of("supervisor"));
}

TEST_CASE("orders: fathom steer pushes while a key or the joystick's button is held, and ends with thrust at zero") {
  for (const bool joystick : {false, true}) {
    CAPTURE(joystick);
    Vehicle vehicle;
    vehicle.start_supervisor();
    const std::string terminal = vehicle.scratch.path("keys"), pad = vehicle.scratch.path("js0");
    link::Server keys{"pty:" + terminal};
    if (joystick) test::shell("mkfifo " + pad);
    const int stick =
        joystick ? open(pad.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;  // both ends: waits for nobody
    const Background tool{vehicle.scratch, "steer",
                          "sh -c \"exec " + program("fathom") + " steer --force 8 --operator " + kOperator +
                              " --bus '" + vehicle.bus.url + "'" + (joystick ? " --joystick " + pad : "") + " < " +
                              terminal + "\""};
    const auto event = [&](std::int16_t value, int type, std::uint8_t number) {
      const js_event e{.time = 0, .value = value, .type = static_cast<std::uint8_t>(type), .number = number};
      CHECK(write(stick, &e, sizeof e) == static_cast<ssize_t>(sizeof e));
    };
    if (joystick) event(0, JS_EVENT_BUTTON | JS_EVENT_INIT, 4);
    const auto said = [&] { return vehicle.bus.said_of("supervisor"); };
    REQUIRE_MESSAGE(vehicle.until([&] { return vehicle.supervisor_says("hold: "); }),
                    test::read_bytes(vehicle.scratch.path("steer.text")));
    if (joystick) {
      event(-32767, JS_EVENT_AXIS, 1);
      vehicle.run(0.5);
      CHECK(std::abs(vehicle.commanded_ahead()) < 1.0);  // nobody holds the button
      event(1, JS_EVENT_BUTTON, 4);
    } else {
      vehicle.meanwhile = [&, i = 0]() mutable {
        if (++i % 6 == 0) keys.send("w");
      };
    }
    CHECK(vehicle.until([&] { return vehicle.pushes_ahead(8.0); }));
    vehicle.run(1.0);
    CHECK(vehicle.commanded_ahead() == doctest::Approx(8.0).epsilon(0.1));  // and goes on
    vehicle.meanwhile = {};
    if (joystick) event(0, JS_EVENT_BUTTON, 4);
    vehicle.run(1.5);
    CHECK(std::abs(vehicle.commanded_ahead()) < 1.0);
    CHECK_MESSAGE(said().find("hold: ") != std::string::npos, said());
    if (joystick) {
      close(stick);  // pulled out
    } else {
      keys.send(" ");
    }
    const auto confirmed = [&] {
      const std::string told = test::read_bytes(vehicle.scratch.path("steer.text"));
      return told.find("aborted, confirmed after") != std::string::npos;
    };
    CHECK_MESSAGE(vehicle.until(confirmed), test::read_bytes(vehicle.scratch.path("steer.text")));
    CHECK(vehicle.until([&] { return vehicle.supervisor_says("aborted: "); }));
    CHECK(vehicle.bus.gate()->armed == 0);
  }
}

TEST_CASE("orders: where the bus leaves this host who arms stays, unless told to leave") {
  if (!test::private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("x.yaml"),
                    "thruster_driver: {protocol: dry_run, rate: 20 Hz, largest_thrust: 30 N}\n");
  const auto ran = test::on_a_network(
      scratch, "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=1'\n" + program("thruster_driver") +
                   " --config x.yaml --config " + file("config/vehicles/bluerov2.yaml") + " --config " + kOperator +
                   " 2>driver.txt &\n"
                   "up() { $fathom status | grep -q thruster_driver; }; within 30 up\n"
                   "arm() { timeout -s INT 8 $fathom arm --no-supervisor --operator " +
                   kOperator +
                   " $*; echo \"code $?\"; }\n"
                   "arm; echo leaves; arm --leave; export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0'; arm\n");
  const auto leaves = ran.text.find("leaves");
  REQUIRE_MESSAGE(leaves != std::string::npos, ran.text);
  const std::string stayed = ran.text.substr(0, leaves), left = ran.text.substr(leaves);
  CHECK_MESSAGE(stayed.find("stays with it, a sign of life every 1.2 s; Ctrl-C aborts") != std::string::npos, ran.text);
  CHECK(stayed.find("code 124") != std::string::npos);  // until it was told to end
  CHECK(left.find("stays with it") == std::string::npos);
  const auto first = left.find("code 0");
  REQUIRE_MESSAGE(first != std::string::npos, ran.text);
  CHECK(left.find("code 0", first + 1) != std::string::npos);
}

TEST_CASE("orders: who armed over a link and is gone is missed") {
  Vehicle vehicle;
  vehicle.start_supervisor();
  {
    const Background tool{
        vehicle.scratch, "attend",
        program("fathom") + " arm --attend 1.5 --operator " + kOperator + " --bus '" + vehicle.bus.url + "'"};
    vehicle.run(6.0);
    CHECK_MESSAGE(vehicle.bus.said_of("supervisor").find("aborted") == std::string::npos,
                  vehicle.bus.said_of("supervisor"));
    test::shell("kill -KILL $(cat " + vehicle.scratch.path("attend.pid") + ")");
  }
  CHECK_MESSAGE(
      vehicle.until([&] { return vehicle.supervisor_says("aborted: the operator is lost: no sign of life"); }),
      vehicle.bus.said_of("supervisor"));
}

}  // namespace fathom

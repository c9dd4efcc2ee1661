// What an operator is told is true, and a stranger on the bus moves nothing: real programs on a bus of their own, and
// the commands arm, abort and steer against them.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "test/support/dry_vehicle.hpp"

namespace fathom {
namespace {

using test::Background;
using test::Bus;
using test::file;
using test::give;
using test::now;
using test::program;
using test::Ran;
using test::Scratch;

const std::string kOperator = test::operator_file();
using Vehicle = test::DryVehicle;

}  // namespace

TEST_CASE("orders: forged and copied commands at 200 Hz move nothing and are named by driver and supervisor") {
  Vehicle vehicle;
  vehicle.start_supervisor();
  const auto armed = vehicle.tool("arm --operator " + kOperator);
  REQUIRE_MESSAGE(armed.code == 0, armed.text);
  vehicle.run(1.0);
  REQUIRE_FALSE(vehicle.bus.commands.empty());
  CHECK(vehicle.bus.said_of("supervisor").find("did not send") == std::string::npos);
  int forged = 0;
  const std::string mine = vehicle.bus.commands.back().commander;
  vehicle.meanwhile = [&] {
    const auto last = std::find_if(vehicle.bus.commands.rbegin(), vehicle.bus.commands.rend(),
                                   [](const auto& each) { return each.tau[1] != 100.0; });
    auto copy = *last;  // commander, arming, challenge and signature as they were said
    copy.utime = now();
    copy.tau[1] = 100.0;
    copy.sequence += 1000;
    vehicle.bus.publish("WRENCH_COMMAND", copy);
    vehicle.bus.publish("WRENCH_COMMAND", *last);  // and once more as it was
    ++forged;
  };
  const std::size_t first = vehicle.bus.thrusters.size();
  vehicle.run(3.0);
  vehicle.meanwhile = {};
  CHECK(forged > 100);
  REQUIRE(vehicle.bus.thrusters.size() > first + 20);
  double sideways = 0.0;
  for (std::size_t i = first; i < vehicle.bus.thrusters.size(); ++i)
    sideways = std::max(sideways, std::abs(vehicle.bus.thrusters[i].tau[1]));
  CHECK(sideways < 15.0);  // what the supervisor itself may ask for: 12 N
  vehicle.run(1.2);
  vehicle.until([&] { return vehicle.bus.said_of("thruster_driver").find("replayed") != std::string::npos; });
  const std::string driver = vehicle.bus.said_of("thruster_driver"), supervisor = vehicle.bus.said_of("supervisor");
  CHECK_MESSAGE(driver.find("not signed with this vehicle's key") != std::string::npos, driver);
  CHECK_MESSAGE(driver.find("replayed") != std::string::npos, driver);
  CHECK_MESSAGE(driver.find(mine) != std::string::npos, driver);
  CHECK_MESSAGE(supervisor.find("commands that I did not send, the last in my own name") != std::string::npos,
                supervisor);
  CHECK_MESSAGE(supervisor.find("lost") == std::string::npos, supervisor);  // the trial goes on
  // Nothing that was said on the bus, and so in a log, holds the key or one that is derived from it.
  const OperatorKeys keys = test::simulated_keys();
  const std::string file = test::read_bytes(std::string{FATHOM_SOURCE_DIR} + "/config/operators/simulated.yaml");
  const std::string hex = file.substr(file.find("key: ") + 5, 16);
  std::size_t looked_at = 0;
  const auto holds_no_key = [&](const auto& messages) {
    for (const auto& message : messages) {
      std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
      message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      CHECK(bytes.find(hex) == std::string::npos);
      for (const Key& key : {keys.order, keys.command, keys.answer})
        CHECK(bytes.find(std::string(key.begin(), key.end())) == std::string::npos);
      ++looked_at;
    }
  };
  for (const char* name : {"driver.text", "supervisor.text"})
    CHECK(test::read_bytes(vehicle.scratch.path(name)).find(hex) == std::string::npos);
  REQUIRE_FALSE(vehicle.bus.commands.empty());
  holds_no_key(vehicle.bus.commands);
  holds_no_key(vehicle.bus.orders);
  holds_no_key(vehicle.bus.answers);
  holds_no_key(vehicle.bus.health);
  CHECK(looked_at > 10);
}

TEST_CASE("orders: an order that is played again after the driver was started again arms nothing") {
  Vehicle vehicle;
  const auto order = give(vehicle.bus, {.enable = true});
  REQUIRE(vehicle.bus.until([&] { return vehicle.bus.gate()->armed != 0; }));
  const auto first = vehicle.bus.gate()->challenge;
  vehicle.driver.reset();
  vehicle.start_driver();
  CHECK(vehicle.bus.gate()->challenge != first);
  test::Commander thief{vehicle.bus};
  thief.obey(order);
  for (int i = 0; i < 20; ++i) {
    vehicle.bus.publish("OPERATOR", order);
    thief.say(test::ahead(20.0));
    vehicle.bus.listen(0.05);
  }
  CHECK(seconds_between(order.utime, now()) < 15.0);
  CHECK(vehicle.bus.gate()->armed == 0);
  CHECK(vehicle.strongest_since(0) == 0.0);
  const auto refused = std::find_if(vehicle.bus.answers.begin(), vehicle.bus.answers.end(),
                                    [&](const auto& each) { return each.sequence == order.sequence; });
  REQUIRE(refused != vehicle.bus.answers.end());
  CHECK(refused->done == 0);
  CHECK(refused->text.find("started again") != std::string::npos);
}

TEST_CASE(
    "orders: fathom abort says NOT CONFIRMED and fails where nobody hears, and is done where THRUSTERS says zero") {
  {
    Bus empty;
    const auto ran = test::shell(program("fathom") + " abort --bus '" + empty.url + "'");
    CHECK(ran.code == 1);
    CHECK_MESSAGE(ran.says("abort NOT CONFIRMED: no thruster driver answered"), ran.text);
    CHECK(ran.says("kill switch"));
  }
  Vehicle vehicle;
  test::Commander commander{vehicle.bus};
  commander.obey(give(vehicle.bus, {.enable = true}));
  vehicle.meanwhile = [&, i = 0]() mutable {
    if (++i % 10 == 0) commander.say(test::ahead(20.0));
  };
  const auto pushed = [&] { return !vehicle.bus.thrusters.empty() && vehicle.bus.thrusters.back().tau[0] > 15.0; };
  REQUIRE(vehicle.until(pushed));
  const auto ran = vehicle.tool("abort --operator " + kOperator);
  CHECK_MESSAGE(ran.code == 0, ran.text);
  CHECK_MESSAGE(ran.says("aborted, confirmed after"), ran.text);
  CHECK(vehicle.bus.thrusters.back().tau[0] == 0.0);
  // A vehicle that goes on whatever its driver asks for.
  vehicle.meanwhile = [&] {
    fathom_lcm::thrusters_t on{};
    on.utime = now();
    on.has_tau = 1;
    on.tau[0] = 20.0;
    vehicle.bus.publish("THRUSTERS", on);
  };
  const auto other = vehicle.tool("abort");
  CHECK(other.code == 1);
  CHECK_MESSAGE(other.says("NOT CONFIRMED: THRUSTERS still says 20"), other.text);
}

TEST_CASE("orders: fathom arm fails with the reason where it is refused or nobody answers") {
  {
    Bus empty;
    const auto ran = test::shell(program("fathom") + " arm --operator " + kOperator + " --bus '" + empty.url + "'");
    CHECK(ran.code == 1);
    CHECK_MESSAGE(ran.says("nobody on this bus moves thrusters"), ran.text);
  }
  Vehicle vehicle;
  const auto alone = vehicle.tool("arm --operator " + kOperator);
  CHECK(alone.code == 1);
  CHECK_MESSAGE(alone.says("NOT OK  supervisor"), alone.text);
  vehicle.deaf_supervisor = true;
  vehicle.run(1.0);
  const auto deaf = vehicle.tool("arm --operator " + kOperator);
  CHECK(deaf.code == 1);
  CHECK_MESSAGE(deaf.says("NOT CONFIRMED: no supervisor answered"), deaf.text);
  vehicle.deaf_supervisor = false;
  CHECK(vehicle.tool("arm --no-supervisor --operator " + kOperator).code == 0);
  std::ofstream{vehicle.scratch.path("other.yaml")} << "operator: {key: " << std::string(64, 'a')
                                                    << ", known_to_all: yes}\n";
  const auto stranger = vehicle.tool("arm --operator " + vehicle.scratch.path("other.yaml"));
  CHECK(stranger.code == 1);
  CHECK_MESSAGE(stranger.says("has another key"), stranger.text);
  vehicle.start_supervisor();
  vehicle.identifier = "fault";
  vehicle.run(0.5);
  const auto listed = vehicle.tool("arm --operator " + kOperator);
  CHECK(listed.code == 1);
  CHECK_MESSAGE(listed.says("not armed: see to what is NOT OK"), listed.text);
  const auto refused = vehicle.tool("arm --needs thruster_driver --operator " + kOperator);
  CHECK(refused.code == 1);
  CHECK_MESSAGE(refused.says("refused by supervisor: not armed: identifier is fault"), refused.text);
  vehicle.identifier = "running";
  vehicle.run(1.0);
  const auto armed = vehicle.tool("arm --operator " + kOperator);
  CHECK_MESSAGE(armed.code == 0, armed.text);
}

TEST_CASE("orders: what the supervisor refuses leaves the thruster driver disarmed, and fathom arm says so") {
  Vehicle vehicle;
  vehicle.identifier = "fault";
  vehicle.start_supervisor();
  const auto gate = [&] { return vehicle.bus.gate()->armed != 0; };
  for (const char* command : {"arm", "fly line"}) {
    CAPTURE(command);
    const auto refused = vehicle.tool(command + std::string{" --needs thruster_driver --operator "} + kOperator);
    CHECK(refused.code == 1);
    CHECK_MESSAGE(refused.says("REFUSED: not armed: identifier is fault"), refused.text);
    CHECK_MESSAGE(refused.says("thruster_driver  not armed"), refused.text);
    CHECK_MESSAGE(vehicle.until([&] { return !gate(); }), vehicle.bus.said_of("thruster_driver"));
  }
  // Nor does it hang on the console: an order alone, whose giver is gone.
  const auto order = give(vehicle.bus, {.enable = true, .order = "identify"});
  const auto taken_back = [&] {
    return vehicle.bus.said_of("thruster_driver").find("not armed: the supervisor refused") != std::string::npos &&
           vehicle.bus.gate()->accepted >= order.sequence && !gate();
  };
  CHECK_MESSAGE(vehicle.until(taken_back), vehicle.bus.said_of("thruster_driver"));
  CHECK(vehicle.strongest_since(0) == 0.0);
  // A controller of somebody else's is armed beside it: the supervisor's word counts for nothing there.
  const auto other = vehicle.tool("arm --no-supervisor --operator " + kOperator);
  CHECK_MESSAGE(other.code == 0, other.text);
  vehicle.run(1.0);
  CHECK(gate());
}

TEST_CASE(
    "preflight: fathom arm says where the vehicle is, and refuses outside of the fence before anything is armed") {
  Vehicle vehicle;
  vehicle.start_supervisor();
  vehicle.north = 9.0;
  vehicle.run(1.0);
  const auto outside = vehicle.tool("arm --operator " + kOperator);
  CHECK(outside.code == 1);
  CHECK_MESSAGE(outside.says("NOT OK  place           too far north: at 9.00 m north"), outside.text);
  CHECK(outside.says("bring it inside the room"));
  CHECK(std::ranges::none_of(vehicle.bus.answers, [](const auto& each) { return each.armed != 0; }));
  vehicle.north = 0.0;
  vehicle.run(1.0);
  const auto inside = vehicle.tool("arm --operator " + kOperator);
  CHECK_MESSAGE(inside.code == 0, inside.text);
  CHECK_MESSAGE(inside.says("ok      place           at 0.00 m north, 0.00 m east, the hull's top "), inside.text);
}

TEST_CASE("preflight: a vehicle that floats is armed, and its thrusters push down alone before it is below") {
  Vehicle vehicle;
  vehicle.start_supervisor();
  vehicle.down = 0.05;  // of a hull 0.25 m high
  vehicle.run(1.0);
  const auto afloat = vehicle.tool("arm --operator " + kOperator);
  CHECK_MESSAGE(afloat.code == 0, afloat.text);
  CHECK_MESSAGE(afloat.says("ok      place           floats, goes down first: at 0.00 m north"), afloat.text);
  CHECK_MESSAGE(vehicle.until([&] { return vehicle.supervisor_says("floats: goes down first"); }),
                vehicle.bus.said_of("supervisor"));
  const auto push = [&](std::size_t axis) {
    return vehicle.bus.commands.empty() ? 0.0 : vehicle.bus.commands.back().tau[axis];
  };
  CHECK(vehicle.until([&] { return push(2) > 1.0; }));
  for (const std::size_t axis : {0U, 1U, 5U}) CHECK(std::abs(push(axis)) < 0.1);
  vehicle.down = 0.9;
  vehicle.north = 0.5;
  CHECK_MESSAGE(vehicle.until([&] { return std::abs(push(0)) > 1.0; }), vehicle.bus.said_of("supervisor"));
}

TEST_CASE("orders: number and time come from the vehicle, whatever the operator's clock shows") {
  Bus bus;
  const Scratch scratch;
  const OperatorKeys keys = test::simulated_keys();
  constexpr Utime kHour = 3'600'000'000;
  const Background tool{
      scratch, "tool", program("fathom") + " arm --no-supervisor --operator " + kOperator + " --bus '" + bus.url + "'"};
  for (int i = 0; i < 60 && bus.orders.empty(); ++i) {  // a vehicle whose clock is an hour behind
    const Answer gate{
        .utime = now() - kHour, .process = "thruster_driver", .gate = true, .challenge = 99, .accepted = 41};
    bus.publish("ANSWER", wire::encode_signed(gate, keys.answer));
    bus.listen(0.1);
  }
  REQUIRE_FALSE(bus.orders.empty());
  CHECK(bus.orders.front().sequence == 42);
  CHECK(bus.orders.front().challenge == 99);
  CHECK(std::abs(seconds_between(bus.orders.front().utime, now() - kHour)) < 1.0);
  CHECK(wire::authentic(bus.orders.front(), keys.order));
}

}  // namespace fathom

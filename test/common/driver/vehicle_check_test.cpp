// What stands behind the thruster driver: each condition that keeps a vehicle from moving as it is told, and the words
// by which an operator learns of it.
#include "common/driver/vehicle_check.hpp"

#include <doctest/doctest.h>

#include <string>

#include "common/devices/checksum.hpp"
#include "common/devices/emulation/emulated_vehicle.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/mavlink.hpp"
#include "common/devices/thruster_text.hpp"

using namespace fathom;
using namespace fathom::driver;

namespace {

bool says(const std::string& text, const char* words) { return text.find(words) != std::string::npos; }

/// The condition of that name.
ConditionLine line(const VehicleCondition& condition, const std::string& name) {
  for (const ConditionLine& each : condition.lines) {
    if (each.name == name) return each;
  }
  FAIL("no line " << name);
  return {};
}

model::Allocated forces(std::vector<double> force) {
  model::Allocated allocated;
  allocated.force = std::move(force);
  return allocated;
}

/// A vehicle that is played, heard through the parser of its protocol.
struct Played final : devices::Output {
  explicit Played(const VehicleCheck::Expected& expected) : check{expected}, rig{settings()} { check.restart(0.0); }
  static VehicleCheck::Expected ardusub() {
    return {.kind = VehicleCheck::Kind::kArdusub,
            .system = 1,
            .modes = {"MANUAL"},
            .voltage_floor = 12.0,
            .must_report = false,
            .largest_thrust = 30.0};
  }
  static VehicleCheck::Expected a_rig() {
    return {.kind = VehicleCheck::Kind::kRig, .voltage_floor = 12.0, .largest_thrust = 30.0};
  }
  static devices::Settings settings() {
    devices::Settings s;
    s.motors = 2;
    return s;
  }
  void frame(const devices::Parser& parser, const devices::Frame& frame) override {
    if (const auto* packet = dynamic_cast<const devices::Mavlink*>(&parser)) check.hear(*packet, now);
    if (const auto* sentence = dynamic_cast<const devices::ThrusterText*>(&parser)) check.hear(*sentence, now);
    if (const auto* battery = std::get_if<const Battery*>(&frame.sample)) check.hear_voltage((*battery)->voltage, now);
  }
  /// It reports ten times a second for so long.
  const VehicleCondition& run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(10.0 * seconds)); ++i) {
      now += 0.1;
      const Thrusters applied{.pwm_us = {1500.0, 1500.0}};
      const std::string bytes = by_mavlink ? devices::mavlink_packets(vehicle, applied, 16.0, 1.7e9 + now)
                                           : devices::rig_sentences(vehicle, applied, 16.0);
      vehicle.words.clear();
      devices::Parser& parser = by_mavlink ? static_cast<devices::Parser&>(mavlink) : rig;
      parser.feed(devices::as_bytes(bytes), *this);
    }
    told = check.condition(1'700'000'000'000'000, now);
    return told;
  }
  VehicleCheck check;
  devices::EmulatedVehicle vehicle;
  devices::Mavlink mavlink{settings()};
  devices::ThrusterText rig;
  bool by_mavlink{true};
  double now{0.0};
  VehicleCondition told;
};

}  // namespace

TEST_CASE("vehicle check: an ArduSub that is well has nothing against it, and each trouble is told with its remedy") {
  Played played{Played::ardusub()};
  CHECK(says(first_trouble(played.check.condition(0, 0.0)), "no heartbeat of the vehicle yet"));
  played.run(3.0);
  CHECK_MESSAGE(first_trouble(played.told).empty(), first_trouble(played.told));
  CHECK(played.told.kind == "ArduSub");
  CHECK(played.told.armed == 1);
  CHECK(played.told.mode == "MANUAL");
  CHECK(played.told.voltage == doctest::Approx(16.0));
  CHECK(played.told.heartbeat_age < 0.2);

  SUBCASE("disarmed") {
    devices::play(played.vehicle, "disarmed");
    CHECK(says(first_trouble(played.run(0.5)), "the vehicle is disarmed: arm it"));
    CHECK(played.told.armed == 0);
    CHECK_FALSE(line(played.told, "armed").grave);
  }
  SUBCASE("another mode") {
    devices::play(played.vehicle, "mode=STABILIZE");
    CHECK(says(first_trouble(played.run(0.5)), "the vehicle is in STABILIZE; it obeys in MANUAL"));
    CHECK(played.told.mode == "STABILIZE");
  }
  SUBCASE("a leak, by its words: for as long as it may be silent about it, and then no more") {
    devices::play(played.vehicle, "says=2,Leak Detected");
    CHECK(says(first_trouble(played.run(0.5)), "the vehicle says 'Leak Detected'"));
    CHECK(line(played.told, "failsafe").grave);
    REQUIRE(played.told.texts.size() == 1);
    CHECK(played.told.texts[0].severity == 2);
    CHECK_FALSE(first_trouble(played.run(25.0)).empty());  // it says so every 20 s
    CHECK(first_trouble(played.run(6.0)).empty());
  }
  SUBCASE("a failsafe, by its heartbeat alone") {
    devices::play(played.vehicle, "failsafe=on");
    CHECK(says(first_trouble(played.run(0.5)), "failsafe is active"));
    CHECK(line(played.told, "failsafe").grave);
    devices::play(played.vehicle, "failsafe=off");
    CHECK(first_trouble(played.run(0.5)).empty());
  }
  SUBCASE("words of no weight, and what spoke against arming before it was armed") {
    devices::play(played.vehicle, "says=4,EKF variance");
    devices::play(played.vehicle, "says=6,EKF is using GPS");
    devices::play(played.vehicle, "says=2,PreArm: Throttle not zero");
    CHECK(first_trouble(played.run(1.0)).empty());
    REQUIRE(played.told.texts.size() == 1);
    CHECK(played.told.texts[0].text == "EKF variance");
  }
  SUBCASE("a battery below its floor, but not one that a start pulls down") {
    devices::play(played.vehicle, "voltage=9.0");
    CHECK(first_trouble(played.run(1.5)).empty());
    devices::play(played.vehicle, "voltage=14.0");
    CHECK(first_trouble(played.run(1.0)).empty());
    devices::play(played.vehicle, "voltage=9.0");
    CHECK(says(first_trouble(played.run(2.5)), "the battery is low: 9.0 V, the floor is 12.0 V"));
    CHECK(line(played.told, "voltage").grave);
  }
  SUBCASE("no heartbeat, although all else comes") {
    devices::play(played.vehicle, "heartbeat=off");
    CHECK(first_trouble(played.run(2.5)).empty());
    CHECK(says(first_trouble(played.run(1.0)), "no heartbeat of the vehicle: none for "));
    CHECK(says(line(played.told, "armed").text, "not known"));
    CHECK_FALSE(line(played.told, "mode").ok);
  }
}

TEST_CASE("vehicle check: with RC override a vehicle that does not report its outputs is told") {
  VehicleCheck::Expected expected = Played::ardusub();
  expected.must_report = true;
  Played played{expected};
  CHECK(says(first_trouble(played.run(3.0)), "SERVO_OUTPUT_RAW"));  // nobody has handed its reports on here
  played.check.applied(forces({0.0, 0.0}), played.now);
  CHECK(first_trouble(played.check.condition(0, played.now)).empty());
}

TEST_CASE("vehicle check: a rig that tells is judged as a vehicle is; an older one by what it has") {
  Played rig{Played::a_rig()};
  rig.by_mavlink = false;
  CHECK(first_trouble(rig.run(3.0)).empty());
  CHECK(rig.told.kind == "rig");
  CHECK(rig.told.armed == 1);
  devices::play(rig.vehicle, "disarmed");
  CHECK(says(first_trouble(rig.run(0.5)), "the rig is disarmed"));
  devices::play(rig.vehicle, "armed");
  devices::play(rig.vehicle, "says=2,Leak in the front tube, port side");
  CHECK(says(first_trouble(rig.run(0.5)), "the vehicle says 'Leak in the front tube, port side'"));
  devices::play(rig.vehicle, "heartbeat=off");
  CHECK(says(first_trouble(rig.run(31.0)), "no heartbeat"));

  Played old{Played::a_rig()};
  old.by_mavlink = false;
  devices::play(old.vehicle, "tells=off");
  CHECK(first_trouble(old.run(3.0)).empty());
  CHECK(old.told.armed == -1);
  CHECK(says(line(old.told, "armed").text, "not told"));
  old.now += 5.0;  // and then nothing
  CHECK(says(first_trouble(old.check.condition(0, old.now)), "no heartbeat"));
  devices::play(old.vehicle, "voltage=9.0");
  CHECK(says(first_trouble(old.run(3.0)), "the battery is low"));
}

TEST_CASE("vehicle check: another firmware, another vehicle, and one that refuses are told with what to do") {
  const auto packet = [](std::uint8_t system, std::uint8_t id, std::uint8_t extra, const std::string& payload) {
    std::string body{static_cast<char>(payload.size())};
    body += std::string("\0\0\0", 3) + static_cast<char>(system) + '\1' + static_cast<char>(id) + std::string(2, '\0');
    body += payload;
    const std::uint16_t crc = devices::crc16_reflected(devices::as_bytes(body + static_cast<char>(extra)), 0xFFFF);
    return "\xFD" + body + static_cast<char>(crc & 0xFFU) + static_cast<char>(crc >> 8);
  };
  const auto heartbeat = [&](std::uint8_t system, char type, char autopilot) {  // armed, MANUAL
    return packet(system, 0, 50, std::string("\x13\0\0\0", 4) + type + autopilot + std::string("\xC0\x04\x03"));
  };
  const auto answer = [&](char result) { return packet(1, 77, 143, std::string("\xD1\0", 2) + result); };
  Played played{Played::ardusub()};
  const auto hear = [&](double now, const std::string& bytes) {
    played.now = now;
    played.mavlink.feed(devices::as_bytes(bytes), played);
    return first_trouble(played.check.condition(0, now));
  };
  CHECK(hear(0.0, heartbeat(1, 12, 3)).empty());
  CHECK(hear(1.0, heartbeat(7, 12, 3)).empty());  // another one beside ours
  CHECK(says(hear(8.0, heartbeat(7, 12, 3)), "set 'system'"));
  CHECK(says(hear(9.0, heartbeat(1, 2, 12)), "not ArduSub"));
  CHECK(hear(10.0, heartbeat(1, 12, 3)).empty());
  CHECK(hear(11.0, answer(0)).empty());
  CHECK(says(hear(11.5, heartbeat(1, 12, 3) + answer(4)), "refuses motor tests (result 4)"));
  CHECK(hear(15.0, heartbeat(1, 12, 3)).empty());

  // What the vehicle says itself is the remedy, unless it only chats.
  const auto words = [&](char severity, const std::string& text) { return packet(1, 253, 83, severity + text); };
  CHECK(says(hear(20.0, heartbeat(1, 12, 3) + words(6, "EKF is using GPS") + answer(4)), "safety switch"));
  CHECK(says(hear(21.0, words(4, "Arm motors first\n") + answer(4)), "(result 4); it says 'Arm motors first'"));
}

TEST_CASE("following: what is asked and not applied, or applied and not asked, is told; delay and weakness are not") {
  const auto flown = [](double seconds, auto asked, auto applied) {
    Following following{{.least = 3.0}};
    std::string told;
    for (int i = 0; i < static_cast<int>(20.0 * seconds); ++i) {
      const double now = 0.05 * i;
      if (i % 4 == 0) following.applied(Eigen::Vector2d{applied(now), 0.0}, now);  // five reports a second
      following.asked(Eigen::Vector2d{asked(now), 0.0}, now);
      if (told.empty()) told = following.trouble(now).empty() ? "" : std::to_string(now) + " " + following.trouble(now);
    }
    return told;
  };
  const auto steps = [](double t) { return std::fmod(t, 6.0) < 3.0 ? 20.0 : -20.0; };
  const auto none = [](double) { return 0.0; };
  CHECK(flown(30.0, steps, steps).empty());
  CHECK(flown(30.0, steps, [&](double t) { return steps(t - 0.3); }).empty());  // a report's delay
  CHECK(flown(30.0, steps, [&](double t) { return 0.5 * steps(t); }).empty());  // a gain of the autopilot
  CHECK(flown(30.0, none, none).empty());
  CHECK(flown(
            30.0, [](double) { return 1.0; }, none)
            .empty());  // within the thrusters' dead band
  const std::string neutral = flown(
      10.0, [](double) { return 50.0; }, none);
  CHECK_MESSAGE(says(neutral, "the thrusters do not follow: of "), neutral);
  CHECK(std::stod(neutral) < 2.0);  // s after the command began
  CHECK(says(flown(10.0, steps, [&](double t) { return -steps(t); }), "do not follow"));
  CHECK(says(flown(10.0, none, [](double) { return 20.0; }), "although nothing is asked"));
}

TEST_CASE("following: a trouble stays told for ten seconds, since without thrust nothing can be seen") {
  Following following{{.least = 3.0}};
  double now = 0.0;
  const auto run = [&](double seconds, double force) {
    for (int i = 0; i < static_cast<int>(20.0 * seconds); ++i, now += 0.05) {
      following.applied(Eigen::Vector2d::Zero(), now);
      following.asked(Eigen::Vector2d{force, 0.0}, now);
    }
    return !following.trouble(now).empty();
  };
  CHECK(run(3.0, 20.0));
  CHECK(run(8.0, 0.0));
  CHECK_FALSE(run(5.0, 0.0));
}

// The vehicle behind the thruster driver, played out of order in every way: HEALTH and VEHICLE say so, arming is
// refused line by line, and a trial ends by it as the vehicle file wants.
#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>
#include <filesystem>
#include <fstream>

#include "common/wire/minds.hpp"
#include "test/support/orders.hpp"

namespace fathom {
namespace {

using test::Background;
using test::Bus;
using test::now;
using test::program;
using test::Scratch;

constexpr char kVehicle[] = "config/vehicles/bluerov2.yaml";

/// The thruster driver and a played ArduSub (or rig) behind it, which begins when the driver is there: conditions go by
/// its time, and a driver is slow to start on a busy machine.
struct Behind {
  Bus bus;
  Scratch scratch;
  Background driver, ardusub;

  explicit Behind(const std::string& conditions, const std::string& protocol = "motor_test")
      : driver{scratch, "driver", command(protocol)}, ardusub{scratch, "ardusub", played(conditions, protocol)} {}
  [[nodiscard]] std::string played(const std::string& conditions, const std::string& protocol) {
    CHECK(bus.until([&] { return bus.gate() != nullptr; }));
    bus.health.clear();
    return program("fathom") + " emulate " + (protocol == "text" ? "thruster_text" : "mavlink") +
           " --to pty:" + scratch.path("tty") + " " + conditions;
  }
  [[nodiscard]] std::string command(const std::string& protocol) const {
    std::ofstream{scratch.path("drivers.yaml")} << "thruster_driver:\n  protocol: " << protocol
                                                << "\n  rate: 20 Hz\n  largest_thrust: 30 N\n"
                                                << "  link: serial://" << scratch.path("tty") << "?baud=115200\n"
                                                << (protocol == "text" ? "" : "  system: 1\n");
    return program("thruster_driver") + " --config " + scratch.path("drivers.yaml") + " --config " +
           test::file(protocol == "text" ? "config/vehicles/beluga.yaml" : kVehicle) + " --config " +
           test::file("config/operators/simulated.yaml") + " --in '" + bus.url + "'";
  }
  /// The first heartbeat has come, and all is as it should be.
  [[nodiscard]] bool is_well() const {
    return !bus.vehicle.empty() &&
           std::ranges::all_of(bus.vehicle.back().lines, [](const auto& line) { return line.ok != 0; });
  }
  /// Words that HEALTH of the driver said while `unhealthy` since the last call.
  [[nodiscard]] std::string complaints() {
    std::string all;
    for (const auto& each : bus.health) {
      if (each.process == "thruster_driver" && each.state == "unhealthy") all += each.detail + "\n";
    }
    bus.health.clear();
    return all;
  }
};

bool says(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

}  // namespace

TEST_CASE("vehicle: whatever keeps a played ArduSub from moving is told by HEALTH and VEHICLE") {
  struct Condition {
    double begin, end;
    const char *word, *back, *told, *line;
  };
  const std::vector<Condition> conditions{
      {5.0, 7.0, "disarmed", "armed", "the vehicle is disarmed: arm it", "armed"},
      {7.0, 9.0, "mode=STABILIZE", "mode=MANUAL", "the vehicle is in STABILIZE; it obeys in MANUAL", "mode"},
      {9.0, 13.5, "heartbeat=off", "heartbeat=on", "no heartbeat of the vehicle: none for ", "heartbeat"},
      {13.5, 15.5, "failsafe=on", "failsafe=off", "the vehicle's own failsafe is active", "failsafe"},
      {15.5, 19.0, "voltage=9.0", "voltage=16.0", "the battery is low: 9.0 V, the floor is 12.0 V", "voltage"},
      {19.0, 21.0, "says=2,Leak Detected", "armed", "the vehicle says 'Leak Detected'", "failsafe"}};
  std::string options;
  for (const Condition& each : conditions) {
    options += " --condition '" + std::to_string(each.begin) + ":" + each.word + "' --condition '" +
               std::to_string(each.end) + ":" + each.back + "'";
  }
  Behind behind{options};
  REQUIRE(behind.bus.until([&] { return behind.is_well(); }));
  (void)behind.complaints();
  CHECK(behind.bus.vehicle.back().kind == "ArduSub");
  CHECK(behind.bus.vehicle.back().armed == 1);
  CHECK(behind.bus.vehicle.back().mode == "MANUAL");
  CHECK(behind.bus.vehicle.back().voltage == doctest::Approx(16.2));
  for (const auto& line : behind.bus.vehicle.back().lines) CHECK_MESSAGE(line.ok, line.text);
  for (const Condition& each : conditions) {
    CAPTURE(each.word);
    std::string told;
    CHECK_MESSAGE(behind.bus.until([&] { return says(told += behind.complaints(), each.told); }), told);
    const auto line_told = [&] {
      return std::ranges::any_of(behind.bus.vehicle, [&](const auto& vehicle) {
        return std::ranges::any_of(vehicle.lines, [&](const auto& line) {
          return line.name == each.line && line.ok == 0 && says(line.text, each.told);
        });
      });
    };
    CHECK(behind.bus.until(line_told));
  }
}

TEST_CASE(
    "vehicle: fathom abort is NOT CONFIRMED where the vehicle behind the driver is silent, whatever was sent to it") {
  Behind behind{""};
  REQUIRE(behind.bus.until([&] { return behind.is_well(); }));
  const std::string abort = program("fathom") + " abort --bus '" + behind.bus.url + "'";
  const auto well = test::shell(abort);
  CHECK_MESSAGE(well.code == 0, well.text);
  CHECK_FALSE(well.says("as it was sent"));  // it reports its outputs
  // Whose own controller commands is told the same, and refused by it.
  const std::string arm = program("fathom") + " arm --no-supervisor --bus '" + behind.bus.url + "' --operator " +
                          test::file("config/operators/simulated.yaml");
  const auto armed = test::shell(arm);
  CHECK_MESSAGE(armed.code == 0, armed.text);
  CHECK_MESSAGE(armed.says("ok      heartbeat"), armed.text);
  kill(std::stoi(test::read_bytes(behind.scratch.path("ardusub.pid"))), SIGKILL);
  REQUIRE(behind.bus.until([&] { return !behind.is_well(); }));
  behind.bus.thrusters.clear();
  const auto gone = test::shell(abort);
  behind.bus.listen(0.2);
  REQUIRE_FALSE(behind.bus.thrusters.empty());  // what is sent into nowhere is zero
  CHECK(behind.bus.thrusters.back().tau[0] == doctest::Approx(0.0));
  CHECK_MESSAGE(gone.code == 1, gone.text);
  CHECK_MESSAGE(gone.says("NOT CONFIRMED: zero was sent, but nobody knows what the vehicle does: no heartbeat"),
                gone.text);
  const auto refused = test::shell(arm);
  CHECK(refused.code == 1);
  CHECK_MESSAGE(refused.says("NOT OK  heartbeat"), refused.text);
}

TEST_CASE("vehicle: a rig that tells by the plain text protocol is judged as well") {
  Behind behind{"--condition 5:disarmed --condition 7:armed --condition '8:says=1,Leak in the front tube'", "text"};
  REQUIRE(behind.bus.until([&] { return behind.is_well(); }));
  CHECK(behind.bus.vehicle.back().kind == "rig");
  const auto complains = [&](const char* words) {
    return behind.bus.until([&behind, words] { return says(behind.complaints(), words); });
  };
  CHECK(complains("the rig is disarmed: arm it"));
  CHECK(complains("the vehicle says 'Leak in the front tube'"));
}

TEST_CASE("vehicle: outputs that stay neutral under a command are told within three seconds") {
  Behind behind{"--condition 0:obeys=off"};
  REQUIRE(behind.bus.until([&] { return behind.bus.gate() != nullptr && behind.is_well(); }));
  (void)behind.complaints();
  test::Commander commander{behind.bus};
  commander.obey(test::give(behind.bus, {.enable = true}));
  REQUIRE(behind.bus.until([&] { return behind.bus.gate()->armed != 0; }));
  for (int i = 0; i < 60; ++i) {
    commander.say(test::ahead(50.0));
    behind.bus.listen(0.05);
  }
  const std::string told = behind.complaints();
  CHECK_MESSAGE(says(told, "the thrusters do not follow: of "), told);
  REQUIRE_FALSE(behind.bus.vehicle.empty());
  CHECK(behind.bus.vehicle.back().asked[0] == doctest::Approx(50.0).epsilon(0.05));
  CHECK(behind.bus.vehicle.back().has_applied == 1);
  CHECK(behind.bus.vehicle.back().applied[0] == doctest::Approx(0.0));
}

namespace {

/// The supervisor with everybody whom it needs, and `fathom arm` beside it.
struct TankTrial {
  Behind behind;
  bool recorder{true};
  std::string full{};  ///< what the recorder says of its disk; empty: all is well
  std::string vehicle_file;
  Background supervisor;

  explicit TankTrial(const std::string& conditions, const std::string& more_of_vehicle = "")
      : behind{conditions},
        vehicle_file{behind.scratch.path("vehicle.yaml")},
        supervisor{behind.scratch, "supervisor", command(more_of_vehicle)} {}
  [[nodiscard]] std::string command(const std::string& more) const {
    test::write_bytes(vehicle_file, test::read_bytes(std::string{FATHOM_SOURCE_DIR} + "/" + kVehicle) + more);
    return program("supervisor") + " --config " + test::file("config/pipelines/deep.yaml") + " --config " +
           vehicle_file + " --config " + test::file("config/sites/deep.yaml") + " --config " +
           test::file("config/operators/simulated.yaml") + " --in '" + behind.bus.url + "'";
  }
  void health(const std::string& process, const std::string& trouble = "") {
    auto message = test::word_of(process, trouble.empty() ? "running" : "unhealthy");
    message.detail = trouble;
    behind.bus.publish("HEALTH", message);
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(20.0 * seconds); ++i) {
      if (i % 10 == 0) {
        for (const char* process : {"estimator", "identifier"}) health(process);
        if (recorder) health("recorder", full);
      }
      StateEstimate state{.utime = now(), .valid = true};
      state.p_WB = {0.0, 0.0, 5.0};
      behind.bus.publish("STATE", wire::encode(state));
      behind.bus.listen(0.05);
    }
  }
  /// What `fathom arm` prints, with "code N" at its end.
  std::string arm() {
    const std::string text = behind.scratch.path("arm.text");
    std::filesystem::remove(text);  // of the arming before
    {
      const Background arms{behind.scratch, "arms",
                            "bash -c \"" + program("fathom") + " arm --operator " +
                                test::file("config/operators/simulated.yaml") + " --bus '" + behind.bus.url + "' > " +
                                text + " 2>&1; echo code \\$? >> " + text + "\""};
      for (int i = 0; i < 120 && !says(test::read_bytes(text), "code "); ++i) run(0.25);
    }
    return test::read_bytes(text);
  }
  [[nodiscard]] std::string said() const {
    const auto& all = behind.bus.health;
    for (auto each = all.rbegin(); each != all.rend(); ++each) {
      if (each->process == "supervisor") return each->detail;
    }
    return {};
  }
  [[nodiscard]] const fathom_lcm::thrusters_t& thrust() const { return behind.bus.thrusters.back(); }
};

}  // namespace

TEST_CASE(
    "preflight: fathom arm prints what is so, line by line, and refuses a disarmed vehicle and a missing recorder") {
  TankTrial trial{"--condition 14:disarmed"};
  trial.recorder = false;
  trial.run(4.0);
  const std::string unrecorded = trial.arm();
  CHECK_MESSAGE(says(unrecorded, "NOT OK  recorder        no HEALTH heard: start it"), unrecorded);
  CHECK(says(unrecorded, "ok      armed           armed"));
  CHECK(says(unrecorded, "code 1"));
  trial.recorder = true;
  for (int i = 0; i < 60 && trial.behind.is_well(); ++i) trial.run(0.5);
  const std::string disarmed = trial.arm();
  CHECK_MESSAGE(says(disarmed, "NOT OK  armed           the vehicle is disarmed: arm it"), disarmed);
  CHECK(says(disarmed, "ok      recorder        running"));
  CHECK(says(disarmed, "code 1"));
  CHECK(trial.said().starts_with("disarmed: "));
}

TEST_CASE(
    "preflight: with all well it arms; a leak then ends the trial at once, and the vehicle goes up as its file says") {
  TankTrial trial{"--condition '20:says=2,Leak Detected'",
                  "after_abort: {action: surface, speed: 0.2 m/s, largest: 20 N, duration: 60 s}\n"};
  trial.run(4.0);
  const std::string armed = trial.arm();
  CHECK_MESSAGE(says(armed, "code 0"), armed);
  CHECK_FALSE(says(armed, "NOT OK"));
  CHECK(says(armed, "ok      thrust          as asked"));
  CHECK(says(armed, "ok      voltage         16.2 V, floor 12.0 V"));
  for (int i = 0; i < 60 && !says(trial.said(), "Leak"); ++i) trial.run(0.5);
  CHECK_MESSAGE(
      trial.said().starts_with("aborted: the vehicle says 'Leak Detected'; then: goes to the surface, at most 60 s"),
      trial.said());
  trial.run(3.0);  // the depth stays 5 m here, so that it goes on pushing
  CHECK(trial.thrust().tau[2] < -2.0);
  CHECK(std::abs(trial.thrust().tau[0]) < 0.5);
  CHECK(test::shell(program("fathom") + " abort --bus '" + trial.behind.bus.url + "'").code == 0);
  trial.run(0.5);
  CHECK(trial.thrust().tau[2] == doctest::Approx(0.0));
  CHECK(trial.said().starts_with("aborted: aborted by the operator"));
}

TEST_CASE(
    "record: a trial whose disk is nearly full has no thrust at once, ends with that reason, and is not armed again") {
  TankTrial trial{""};
  trial.run(4.0);
  REQUIRE(says(trial.arm(), "code 0"));
  trial.run(2.0);
  REQUIRE_FALSE(trial.said().starts_with("aborted"));
  trial.full = "the disk is nearly full: 20.0 MB free, full in 95 s at 0.2 MB/s; 10 messages written";
  trial.run(1.5);
  CHECK(trial.thrust().tau[2] == doctest::Approx(0.0));
  CHECK(std::abs(trial.thrust().tau[0]) < 1e-9);
  trial.run(7.0);
  CHECK_MESSAGE(trial.said().starts_with("aborted: recorder is unhealthy: the disk is nearly full: 20.0 MB free"),
                trial.said());
  const std::string again = trial.arm();
  CHECK_MESSAGE(says(again, "NOT OK  recorder        unhealthy: the disk is nearly full: 20.0 MB free"), again);
  CHECK(says(again, "code 1"));
}

}  // namespace fathom

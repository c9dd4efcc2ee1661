// The simulator as a process, with real followers on a private network: the same bits in lockstep and in real time, and
// what happens when somebody is missing, dies, or comes twice.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "common/base/event_log.hpp"
#include "common/wire/log_reader.hpp"
#include "test/support/channels.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/timing.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;
using test::Ran;
using test::Scratch;
using test::shell;

bool private_network() {
  if (shell("unshare -rn ip link set lo up").code == 0) return true;
  MESSAGE("skipped: this machine allows no private network (unshare -rn)");
  return false;
}

const std::string kBus = "udpm://239.255.76.67:7667?ttl=0";

std::string simulator(const std::string& options, const std::string& site = "tank") {
  return program("simulator") + " --config " + file("config/vehicles/seabotix_lbv150.yaml") + " --config " +
         file("config/sites/" + site + ".yaml") + " --config " + file("config/simulation/seabotix_lbv150.yaml") +
         " --config " + file("config/operators/simulated.yaml") + " " + options;
}

std::string pilot() { return std::string{"'"} + FATHOM_BINARY_DIR + "/test/test_pilot'"; }

/// Runs a script on a network of its own. Each line ends in its own time; `wait` collects what went to the background.
Ran on_private_network(const std::string& script) {
  return shell(test::limit(60) +
               "unshare -rn sh -c \"ip link set lo up; ip route add 224.0.0.0/4 dev lo; export LCM_DEFAULT_URL='" +
               kBus + "'\n" + script + "\"");
}

/// A whole run with a pilot: in lockstep recorded by our own recorder, in real time by lcm-logger.
Ran flight(const Scratch& scratch, const std::string& log, const std::string& options, bool lockstep) {
  const std::string path = scratch.path(log);
  if (lockstep) {
    return on_private_network(program("recorder") + " --lockstep --file " + path + " &\n" + pilot() +
                              " --lockstep &\n" + simulator(options + " --wait-for test_pilot,recorder") +
                              "\ncode=\\$?\nwait\nexit \\$code");
  }
  return on_private_network("lcm-logger -q -f --lcm-url='" + kBus + "&recv_buf_size=2097152' " + path +
                            " >/dev/null 2>&1 & logger=\\$!\n" + pilot() + " & pilot=\\$!\nsleep 1\n" +
                            simulator(options) +
                            "\ncode=\\$?\nsleep 0.3\nkill \\$pilot \\$logger 2>/dev/null\nwait\nexit \\$code");
}

/// Every message of the simulator and the pilot, by channel, in order. What is the wall's own is left out.
std::map<std::string, std::vector<std::string>> messages(const std::string& path) {
  std::map<std::string, std::vector<std::string>> found;
  EventLog log{path};
  while (const auto event = log.next()) {
    const std::string channel{event->channel};
    if (channel == "HEALTH" || channel == "PROCESS_INFO" || channel.starts_with("LOCKSTEP") ||
        channel == "LCM_SELF_TEST") {
      continue;
    }
    found[channel].emplace_back(event->data.begin(), event->data.end());
  }
  return found;
}

}  // namespace

TEST_CASE("simulator: hears and says what docs/messages.md tells") {
  const auto ran = shell(simulator("--interface"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const test::Channels actual = test::channels_of(ran.text);
  const test::Channels stated = test::channels_in_docs("simulator");
  CHECK(actual.hears == stated.hears);
  CHECK(actual.says == stated.says);
}

TEST_CASE("simulator: lockstep twice, lockstep at the wall's pace and plain real time give the same bits") {
  if (!private_network()) return;
  const Scratch scratch;
  const std::string common = "--duration 4 --seed 11 --order 0=enable --hide thruster_lag ";
  const auto fast = flight(scratch, "fast.lcmlog", common + "--speed 0", true);
  REQUIRE_MESSAGE(fast.code == 0, fast.text);
  const auto again = flight(scratch, "again.lcmlog", common + "--speed 0", true);
  REQUIRE_MESSAGE(again.code == 0, again.text);
  const auto paced = flight(scratch, "paced.lcmlog", common + "--speed 2", true);
  REQUIRE_MESSAGE(paced.code == 0, paced.text);
  const auto wanted = messages(scratch.path("fast.lcmlog"));
  REQUIRE(wanted.contains("AHRS"));
  CHECK(wanted.at("AHRS").size() == 399);  // from 5 ms on; that of 3.995 s is still under way
  CHECK(wanted.at("THRUSTERS").size() == 200);
  CHECK(wanted.at("WRENCH_COMMAND").size() == 199);
  CHECK(messages(scratch.path("again.lcmlog")) == wanted);
  CHECK(messages(scratch.path("paced.lcmlog")) == wanted);
  if (!test::kTimed) return;  // the sanitizers are too slow for the wall's clock
  // Another job on the machine may hold a process up for longer than an interval; then the simulator says so.
  for (int attempt = 0; attempt < 5; ++attempt) {
    const auto real = flight(scratch, "real.lcmlog", common + "--speed 1", false);
    REQUIRE_MESSAGE(real.code == 0, real.text);
    if (messages(scratch.path("real.lcmlog")) == wanted) break;
    if (attempt == 4) FAIL_CHECK("five runs in real time, none with the bits of lockstep: " << real.text);
  }
}

TEST_CASE("simulator: minds in lockstep, and the same minds on the recorded log: the same bits") {
  if (!private_network()) return;
  const Scratch scratch;
  const std::string vehicle = " --config " + file("config/vehicles/beluga.yaml");
  const std::string minds = vehicle + " --config " + file("config/pipelines/beluga.yaml") + " --config " +
                            file("config/corrections/none.yaml");
  const auto ran = on_private_network(
      program("recorder") + " --lockstep --file " + scratch.path("run.lcmlog") + " &\n" + pilot() + " --lockstep &\n" +
      program("estimator") + " --lockstep" + minds + " &\n" + program("identifier") + " --lockstep" + minds + " &\n" +
      program("simulator") + vehicle + " --config " + file("config/operators/simulated.yaml") + " --config " +
      file("config/sites/tank.yaml") + " --config " + file("config/simulation/beluga.yaml") +
      " --speed 0 --duration 60 --order 0=enable --wait-for recorder,test_pilot,estimator,identifier\nwait");
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const std::string in = " --in file://" + scratch.path("run.lcmlog");
  const auto estimator = shell(program("estimator") + minds + in + " --out file://" + scratch.path("state.lcmlog"));
  REQUIRE_MESSAGE(estimator.code == 0, estimator.text);
  const auto identifier = shell(program("identifier") + minds + in + " --out file://" + scratch.path("model.lcmlog"));
  REQUIRE_MESSAGE(identifier.code == 0, identifier.text);
  auto live = messages(scratch.path("run.lcmlog"));
  REQUIRE(live["STATE"].size() > 500);
  REQUIRE(live["MODEL"].size() > 50);
  CHECK(messages(scratch.path("state.lcmlog"))["STATE"] == live["STATE"]);
  CHECK(messages(scratch.path("model.lcmlog"))["MODEL"] == live["MODEL"]);
  const auto health = wire::read_log(scratch.path("run.lcmlog")).recording.health;
  CHECK(!health.empty());
  CHECK(std::ranges::all_of(health, [](const Health& each) { return each.dropped == 0; }));  // all are kept
}

TEST_CASE(
    "simulator: nothing reaches the thrusters from a commander who was there first, until enable; abort stops it") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = flight(scratch, "run.lcmlog", "--duration 4 --speed 0 --order 1=enable --order 3=abort", true);
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const auto thrusters = wire::read_log(scratch.path("run.lcmlog")).recording.thrusters;
  REQUIRE(thrusters.size() == 200);
  for (const Thrusters& sample : thrusters) {
    const double t = seconds_between(1'700'000'000'000'000, sample.utime);
    const bool pushes = std::any_of(sample.tau.begin(), sample.tau.end(), [](double x) { return x != 0.0; });
    CAPTURE(t);
    if (t < 0.99 || t > 3.07) CHECK_FALSE(pushes);
    if (t > 1.1 && t < 2.99) CHECK(pushes);
  }
}

TEST_CASE("simulator: a commander who falls silent is obeyed for his command's life and no longer") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran =
      on_private_network("lcm-logger -q -f " + scratch.path("run.lcmlog") + " >/dev/null 2>&1 & logger=\\$!\n" +
                         "(sleep 0.4; timeout 1.2 " + pilot() + ") &\n" +
                         simulator("--duration 3 --speed 1 --order 0=enable") + "\nsleep 0.3; kill \\$logger; wait");
  const auto recording = wire::read_log(scratch.path("run.lcmlog")).recording;
  REQUIRE_MESSAGE(!recording.wrench_command.empty(), ran.text);
  const Utime last = recording.wrench_command.back().utime;
  for (const Thrusters& sample : recording.thrusters) {
    if (seconds_between(last, sample.utime) > 0.36) CHECK(sample.tau[0] == 0.0);  // its life is 0.3 s
  }
}

TEST_CASE("simulator: truth.json holds what was hidden") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = on_private_network(
      simulator("--duration 1 --speed 1 --seed 5 --hide current=v_N:0.2,v_E:-0.1 --out-dir " + scratch.path("out")));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const auto truth = nlohmann::json::parse(test::read_bytes(scratch.path("out/truth.json")));
  CHECK(truth["vehicle"] == "SeaBotix LBV150");
  CHECK(truth["site"] == "tank");
  CHECK(truth["seed"] == 5);
  CHECK(truth["parameters"]["N_r|r|"]["value"] == -10.3483);
  CHECK(truth["effects"][0]["name"] == "current");
  CHECK(truth["effects"][0]["parameters"]["v_E"]["value"] == -0.1);
  CHECK(truth["drawn"].contains("tag_pose.scale_error"));
  CHECK(truth["contacts"]["walls"] == 0);
}

TEST_CASE("simulator: the second one on a bus is refused by name, the first goes on") {
  if (!private_network()) return;
  const auto ran = on_private_network(simulator("--duration 3 --speed 1") + " & first=\\$!\nsleep 1\n" +
                                      simulator("--duration 3 --speed 1") +
                                      "\necho second ended with \\$?\nwait \\$first\necho first ended with \\$?");
  CHECK_MESSAGE(ran.says("another simulator is already running on this bus"), ran.text);
  CHECK_MESSAGE(ran.says("second ended with 1"), ran.text);
  CHECK_MESSAGE(ran.says("first ended with 0"), ran.text);
}

TEST_CASE("simulator: a follower that restarts, a stranger, and words that do not go together: one line each") {
  if (private_network()) {
    const auto restarted = on_private_network(
        pilot() + " --lockstep & first=\\$!\n(sleep 1.2; kill \\$first; sleep 0.1; timeout 3 " + pilot() +
        " --lockstep) &\n" + simulator("--duration 20 --speed 1 --wait-for test_pilot") + "\necho ended with \\$?");
    CHECK_MESSAGE(restarted.says("test_pilot was started anew in the middle of the run"), restarted.text);
    CHECK_MESSAGE(restarted.says("ended with 1"), restarted.text);
    const auto alone = on_private_network("timeout 8 " + pilot() + " --lockstep &\ntimeout 7 " +
                                          simulator("--duration 20 --speed 0 --wait-for test_pilot,estimator"));
    CHECK_MESSAGE(alone.says("waits for estimator; start them with --lockstep"), alone.text);
    const auto stranger =
        on_private_network("timeout 5 " + pilot() + " --lockstep &\n" +
                           simulator("--duration 20 --speed 1 --wait-for estimator") + "\necho ended with \\$?");
    CHECK_MESSAGE(stranger.says("test_pilot follows but nobody waits for it; name it with --wait-for"), stranger.text);
  }
  CHECK(shell(simulator("--speed 0")).says("say with --wait-for which processes to wait for"));
  CHECK(shell(simulator("--order soon=enable")).says("--order soon=enable: write SECONDS=WORD"));
  CHECK(shell(simulator("--hide ghost")).says("--hide ghost: no effect 'ghost'"));
  CHECK(shell(pilot() + " --lockstep --in file://x.lcmlog --out file://y.lcmlog").says("only a live bus"));
  CHECK(shell(simulator("--hide ghost")).lines() == 1);
}

}  // namespace fathom

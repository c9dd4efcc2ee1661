// Deputy and sheriff with real programs on a private network: trials start and stop by one command, programs are
// watched and brought back, two of a name are told, and nothing is left behind.
#include <doctest/doctest.h>

#include <algorithm>
#include <fathom_lcm/wrench_command_t.hpp>

#include "common/base/event_log.hpp"
#include "common/wire/log_reader.hpp"
#include "test/support/private_network.hpp"
#include "test/support/timing.hpp"

namespace fathom {
namespace {

using test::on_a_network;
using test::private_network;
using test::Scratch;

std::string hostile() { return std::string{"'"} + FATHOM_BINARY_DIR + "/test/test_hostile'"; }

/// Of all commanders; a supervisor that was not armed gives none.
Utime last_command(const std::string& path) {
  Utime last = 0;
  EventLog log{path};
  while (const auto event = log.next()) {
    fathom_lcm::wrench_command_t command{};
    const int length = static_cast<int>(event->data.size());
    if (event->channel != "WRENCH_COMMAND" || command.decode(event->data.data(), 0, length) != length) continue;
    last = command.utime;
  }
  return last;
}

constexpr char kPrograms[] = R"(
group "g" {
  cmd "sleeper" { exec = "sleep \"1000\""; deputy = "vehicle"; auto_respawn = "true"; }
  cmd "once" { exec = "A=b bash -c \"echo hello $A; exit 0\""; deputy = "vehicle"; }
  cmd "stubborn" { exec = "bash -c \"trap '' INT; while true; do sleep 100; done\""; deputy = "topside"; stop_time_allowed = 1; }
}
cmd "missing" { exec = "no-such-program -x"; deputy = "topside"; }
script "go" { start cmd "sleeper" wait "running"; start cmd "once" wait "stopped"; start cmd "stubborn" wait "running"; }
script "sleeper" { start cmd "sleeper" wait "running"; }
script "bad" { start cmd "missing" wait "running"; start cmd "sleeper"; }
)";

}  // namespace

TEST_CASE("launch: one command starts programs on two deputies and leaves nothing behind") {
  if (!private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("x.cfg"), kPrograms);
  const auto ran = on_a_network(scratch, "$sheriff x.cfg --script go --local; echo \"code $?\"; pgrep -a sleep\n");
  CHECK_MESSAGE(ran.says("sleeper   vehicle  running"), ran.text);
  CHECK(ran.says("once      vehicle  stopped"));
  CHECK(ran.says("stubborn  topside  running"));
  CHECK(ran.says("code 0"));
  CHECK_FALSE(ran.says("sleep 100"));
}

TEST_CASE("launch: what cannot be run fails the script, is told with its reason, and the exit code says so") {
  if (!private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("x.cfg"), kPrograms);
  const auto ran = on_a_network(scratch, "$sheriff x.cfg --script bad --local; echo \"code $?\"\n");
  CHECK_MESSAGE(ran.says("x.cfg:10: missing failed: exit 255"), ran.text);
  CHECK(ran.says("no-such-program: No such file or directory"));
  CHECK(ran.says("code 1"));
  CHECK_FALSE(ran.says("sleeper on vehicle: starting"));
}

TEST_CASE("launch: a killed program comes back, a second sheriff adopts what runs, a second deputy is refused") {
  if (!private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("x.cfg"), kPrograms);
  test::write_bytes(
      scratch.path("y.cfg"),
      "cmd \"other\" { exec = \"sleep 2000\"; deputy = \"vehicle\"; }\nscript \"go\" { start cmd \"other\" "
      "wait \"running\"; }\n");
  const auto ran = on_a_network(scratch,
                                "$deputy -i vehicle 2>deputy.txt & d=$!; up deputy.txt\n"
                                "$deputy -i vehicle; echo \"second $?\"\n"
                                "$sheriff x.cfg --script sleeper; echo \"start $?\"\n"
                                "a=$(pid 'sleep 1000'); kill -9 $a; until_new 'sleep 1000' $a\n"
                                "$sheriff y.cfg --script go; echo \"other $?\"\n"
                                "[ \"$(pid 'sleep 1000')\" = $b ] && echo adopted\n"
                                "$sheriff x.cfg --stop >/dev/null; pgrep -a sleep; kill $d; wait $d; echo "
                                "\"end $?\"; cat deputy.txt\n");
  CHECK_MESSAGE(ran.says("second 2"), ran.text);
  CHECK(ran.says("another deputy named vehicle is on"));
  CHECK(ran.says("start 0"));
  CHECK(ran.says("sleeper: Killed"));
  CHECK(ran.says("other 0"));
  CHECK(ran.says("adopted"));
  CHECK_FALSE(ran.says("sleep 1000\n"));
  CHECK(ran.says("end 0"));
}

TEST_CASE("launch: of deputies of one name that start together one stays") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = on_a_network(scratch,
                                "for i in 1 2 3; do $deputy -i vehicle 2>>deputies.txt & done; up deputies.txt\n"
                                "one() { [ $(jobs -r | wc -l) = 1 ]; }; within 10 one; sleep 1\n"
                                "echo \"left $(jobs -r | wc -l)\"; kill $(jobs -p); wait; cat deputies.txt\n");
  CHECK_MESSAGE(ran.says("left 1\n"), ran.text);
  CHECK(ran.says("another deputy named vehicle"));
}

TEST_CASE("launch: a killed deputy takes its programs along, and its successor is given their work") {
  if (!private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("x.cfg"), kPrograms);
  const auto ran = on_a_network(scratch,
                                "$deputy -i vehicle 2>first.txt & d=$!; up first.txt\n"
                                "$sheriff x.cfg --script sleeper --stay >sheriff.txt & s=$!\n"
                                "runs() { grep ^sleeper sheriff.txt | tail -n 1 | grep -q running; }; within 20 runs\n"
                                "a=$(pid 'sleep 1000'); kill -9 $d; dead() { ! kill -0 $a 2>/dev/null; }\n"
                                "within 5 dead; dead && echo gone\n"
                                "$deputy -i vehicle 2>second.txt & d=$!\n"
                                "until_new 'sleep 1000' $a; sleep 1.5; within 20 runs\n"
                                "kill -INT $s; wait $s; echo \"sheriff $?\"; kill $d; wait $d; cat sheriff.txt\n");
  CHECK_MESSAGE(ran.says("gone"), ran.text);
  CHECK_FALSE(ran.says("not within"));
  CHECK_FALSE(ran.says("no new sleep"));
  CHECK(ran.says("sheriff 0"));
}

TEST_CASE(
    "launch: a killed sheriff leaves all running for the next one, but what it had started on its own host ends") {
  if (!private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("x.cfg"), kPrograms);
  const auto ran =
      on_a_network(scratch,
                   "$deputy -i vehicle 2>deputy.txt & d=$!; up deputy.txt\n"
                   "runs() { grep -s ^sleeper $1 | tail -n 1 | grep -q running; }\n"
                   "$sheriff x.cfg --script sleeper --stay >sheriff.txt & s=$!; within 20 runs sheriff.txt\n"
                   "a=$(pid 'sleep 1000'); kill -9 $s; sleep 1\n"
                   "$sheriff x.cfg --status | grep ^sleeper; [ \"$(pid 'sleep 1000')\" = $a ] && echo stays\n"
                   "kill $d; wait $d\n"
                   "$sheriff x.cfg --script sleeper --stay --local >own.txt & s=$!; within 20 runs own.txt\n"
                   "kill -9 $s; nobody() { ! pgrep -f 'sleep 1000|deputy --id' >/dev/null; }\n"
                   "within 10 nobody; nobody && echo gone\n");
  CHECK_MESSAGE(ran.says("sleeper   vehicle  running"), ran.text);
  CHECK(ran.says("stays"));
  CHECK(ran.says("gone"));
  CHECK_FALSE(ran.says("not within"));
}

TEST_CASE("launch: a simulated trial in lockstep by one command") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = on_a_network(
      scratch,
      "export FATHOM_SIMULATION='--duration 20 --seed 4 --order 1=identify'\n"
      "$sheriff $configs/lockstep.cfg --script simulated-trial --local; echo \"code $?\"; pgrep -a fathom\n");
  CHECK_MESSAGE(ran.says("code 0"), ran.text);
  CHECK_FALSE(ran.says("fathom-"));
  const Recording run = wire::read_log(scratch.path("trial.lcmlog")).recording;
  REQUIRE(run.excitation.size() > 100);
  CHECK(run.excitation.back().mode == "yaw");
}

TEST_CASE(
    "launch: in a trial in real time every mind is killed and one is halted: all come back, thrusters stop in time") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = on_a_network(
      scratch,
      "export FATHOM_SIMULATION='--duration 300 --speed 1 --seed 4 --order 2=identify --order 5=identify'\n"
      "$sheriff $configs/tank.cfg --script simulated-trial --local -v >sheriff.txt & s=$!\n"
      "within 40 grep -q approach sheriff.txt; sleep 3\n"
      "for p in estimator identifier; do a=$(pid fathom-$p); kill -9 $a; until_new fathom-$p $a; sleep 1.5; done\n"
      "a=$(pid fathom-identifier); kill -STOP $a; until_new fathom-identifier $a; sleep 1.5\n"
      "a=$(pid fathom-supervisor); kill -9 $a; until_new fathom-supervisor $a; sleep 1.5\n"
      "$fathom status; kill -INT $(pid fathom-simulator); wait $s; echo \"code $?\"; cat sheriff.txt\n",
      120);
  CHECK_MESSAGE(ran.says("code 0"), ran.text);
  CHECK_FALSE(ran.says("no new"));
  CHECK(ran.says("identifier on vehicle: running, silent"));
  CHECK(ran.says("identifier: says no HEALTH for "));
  CHECK(ran.says(" s and does nothing; killed"));
  CHECK(ran.says("goes on from "));  // with what it had learnt
  CHECK(ran.says("zero thrust: commands have stopped"));
  const Recording run = wire::read_log(scratch.path("trial.lcmlog.00")).recording;
  const auto pushes = [](const Thrusters& t) {
    return std::any_of(t.tau.begin(), t.tau.end(), [](double x) { return x != 0.0; });
  };
  Utime last_push = 0;
  for (const Thrusters& t : run.thrusters) {
    if (pushes(t)) last_push = t.utime;
  }
  REQUIRE(last_push > 0);
  const Utime died = last_command(scratch.path("trial.lcmlog.00"));
  constexpr double kLife = 0.5;  // s, of the vehicle's promise
  CHECK(seconds_between(died, last_push) < kLife);
  MESSAGE("thrust ended " << seconds_between(died, last_push) << " s after the supervisor's last command");
}

TEST_CASE("launch: in real time without a deputy, who brings nobody back, a needed process that dies ends the trial") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = on_a_network(
      scratch,
      "share=${configs%procman}config programs=${deputy%deputy}\n"
      "site=\"--config $share/vehicles/seabotix_lbv150.yaml --config $share/sites/tank.yaml\"\n"
      "minds=\"--config $share/pipelines/tank.yaml --config $share/corrections/none.yaml\"\n"
      "operator=\"--config $share/operators/simulated.yaml\"\n"
      "identify() { ${programs}identifier $minds --config $share/vehicles/seabotix_lbv150.yaml 2>identifier.txt & "
      "i=$!; }\n"
      "${programs}estimator $minds $site 2>estimator.txt & identify\n"
      "${programs}supervisor --config $share/pipelines/tank.yaml $site $operator 2>supervisor.txt &\n"
      "${programs}recorder --file trial.lcmlog 2>recorder.txt & r=$!; sleep 1\n"
      "${programs}simulator $operator --config $share/simulation/seabotix_lbv150.yaml $site --order 2=identify "
      "--order 4=identify --order 6=identify >simulator.txt 2>&1 &\n"
      "within 20 grep -q 'settles mode\\|goes to where' supervisor.txt; sleep 8; kill -9 $i; kill -0 $i\n"
      "within 20 grep -q 'aborted: identifier is silent' supervisor.txt\n"
      "arm() { $fathom arm --operator $share/operators/simulated.yaml $*; }\n"
      "arm; echo \"listed $?\"; arm --needs estimator; echo \"refused $?\"; identify; sleep 2; arm; echo \"armed $?\"; "
      "kill -INT $r; wait $r; cat supervisor.txt\n",
      90);
  CHECK_FALSE(ran.says("not within"));
  CHECK_MESSAGE(ran.says("aborted: identifier is silent: no HEALTH for 1"), ran.text);
  CHECK_MESSAGE(ran.says("NOT OK  identifier"), ran.text);
  CHECK(ran.says("listed 1"));
  CHECK(ran.says(
      "refused by supervisor: not armed: identifier is silent: no HEALTH for "));  // whoever goes past the list
  CHECK(ran.says("refused 1"));
  CHECK(ran.says("the sheriff's table tells why it does not run; then arm again"));
  CHECK(ran.says("armed 0"));
  const Recording run = wire::read_log(scratch.path("trial.lcmlog")).recording;
  const auto lost = std::find_if(run.excitation.begin(), run.excitation.end(), [](const Excitation& each) {
    return each.phase == "lost" && each.reason.starts_with("no thrust: identifier is silent");
  });
  const auto aborted = std::find_if(run.excitation.begin(), run.excitation.end(),
                                    [](const Excitation& each) { return each.phase == "aborted"; });
  REQUIRE(lost != run.excitation.end());
  REQUIRE(aborted != run.excitation.end());
  CHECK(seconds_between(run.model.front().utime, lost->utime) > 5.0);
  constexpr double kLife = 0.5;  // s
  for (const Thrusters& each : run.thrusters) {
    const bool pushes = std::any_of(each.tau.begin(), each.tau.end(), [](double x) { return x != 0.0; });
    if (seconds_between(lost->utime, each.utime) > kLife && each.utime < aborted->utime) CHECK_FALSE(pushes);
  }
  MESSAGE("no thrust " << seconds_between(lost->utime, aborted->utime) << " s before the abort");
}

TEST_CASE("launch: broken messages on every channel and a flood kill nobody, move nothing and are named") {
  if (!private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("drivers.yaml"),
                    "thruster_driver: {protocol: dry_run, rate: 20 Hz, largest_thrust: 13 N}\n");
  const auto ran = on_a_network(
      scratch,
      "export FATHOM_SIMULATION='--duration 15 --seed 4 --order 1=identify'\n"
      // What deputies and sheriffs say belongs to it too, but shall not command our deputy.
      "sed 's/\"vehicle\"/\"elsewhere\"/' $configs/lockstep.cfg >elsewhere.cfg\n"
      "${deputy%deputy}recorder --file hostile.lcmlog & l=$!\n"
      "$sheriff elsewhere.cfg --script simulated-trial --local >/dev/null; kill -INT $l; wait $l\n"
      "cp ${configs%procman}config/operators/simulated.yaml operator.yaml\n"
      "cp ${configs%procman}config/vehicles/bluerov2.yaml driven.yaml\n"
      "$deputy -i vehicle 2>deputy.txt & d=$!; up deputy.txt\n"
      "sed -e 's/operator.yaml --config .FATHOM_VEHICLE/operator.yaml --config driven.yaml/' "
      "-e 's/start group \"drivers\"/start cmd \"thruster_driver\"/' $configs/tank.cfg >x.cfg\n"
      "$sheriff x.cfg --script tank-trial >/dev/null; echo \"start $?\"\n"
      "pids=$(for p in estimator identifier supervisor thruster_driver; do pid fathom-$p; done; echo $d)\n"
      "${deputy%deputy}recorder --file after.lcmlog & l=$!\n" +
          hostile() +
          " \"$LCM_DEFAULT_URL\" 2 hostile.lcmlog trial.lcmlog; echo \"hostile $?\"; sleep 2; kill -INT $l; wait $l\n"
          "for p in $pids; do kill -0 $p && echo \"alive $(awk '/VmHWM/ { print $2 }' /proc/$p/status)\"; done\n"
          "$fathom status; grep -a -o 'AHRS flood, per second [0-9]*' after.lcmlog | sort -u\n"
          "$sheriff x.cfg --stop; echo \"code $?\"; kill $d; wait $d; cat deputy.txt\n",
      120);
  std::size_t alive = 0;
  for (auto at = ran.text.find("alive "); at != std::string::npos; at = ran.text.find("alive ", at + 1)) {
    ++alive;
    // kB; queues of 1000 messages and the minds' own. A sanitizer's shadow of the memory is not theirs.
    if (test::kTimed) CHECK(std::stol(ran.text.substr(at + 6)) < 300'000);
  }
  CHECK_MESSAGE(alive == 5, ran.text);
  CHECK_MESSAGE(ran.says("hostile 0"), ran.text);
  CHECK(ran.says("AHRS flood, per second"));
  CHECK(ran.says("start 0"));
  CHECK(ran.says("zero thrust: "));
  CHECK_MESSAGE(ran.says("orders refused"), ran.text);
  CHECK(ran.says("code 0"));
}

TEST_CASE("launch: a second process of the same name is told by both, and a full disk by the logger's failure") {
  if (!private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("x.cfg"),
                    "cmd \"logger\" { exec = \"fathom-recorder --file full/a.lcmlog\"; deputy = \"vehicle\"; "
                    "auto_respawn = \"true\"; }\nscript \"go\" { start cmd \"logger\"; wait ms 6000; }\n");
  const auto ran = on_a_network(
      scratch,
      "share=${configs%procman}config programs=${deputy%deputy}\n"
      "site=\"--config $share/vehicles/seabotix_lbv150.yaml --config $share/sites/tank.yaml\"\n"
      "for i in first second; do ${programs}estimator --config $share/pipelines/tank.yaml $site 2>$i.txt & done\n"
      "for i in first second; do within 20 grep -qs 'another estimator' $i.txt; done; sleep 1; $fathom status\n"
      // Room for the first few messages.
      "mkdir full; mount -t tmpfs -o size=64k none full; head -c 56k /dev/zero >full/filler\n"
      "${programs}simulator --config $share/operators/simulated.yaml --config $share/simulation/seabotix_lbv150.yaml "
      "$site "
      ">/dev/null 2>&1 &\n"
      "$sheriff x.cfg --script go --local; echo \"code $?\"\n");
  CHECK_MESSAGE(ran.says("another estimator speaks on this bus (process "), ran.text);
  CHECK(test::read_bytes(scratch.path("first.txt")).find("another estimator") != std::string::npos);
  CHECK(test::read_bytes(scratch.path("second.txt")).find("another estimator") != std::string::npos);
  CHECK(ran.says("is the disk full?"));
  CHECK(ran.says("logger on vehicle "));
  CHECK(ran.says("exit 1"));
  CHECK(ran.says("code 1"));
}

}  // namespace fathom

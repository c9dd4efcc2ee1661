// Deputy and sheriff with real programs on a private network: trials start and stop by one command, programs are
// watched and brought back, two of a name are told, and nothing is left behind.
#include <doctest/doctest.h>

#include "common/wire/log_reader.hpp"
#include "test/support/private_network.hpp"
#include "test/support/timing.hpp"

namespace fathom {
namespace {

using test::on_a_network;
using test::private_network;
using test::Scratch;

std::string hostile() { return std::string{"'"} + FATHOM_BINARY_DIR + "/test/test_hostile'"; }

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
                                "vehicle\n"
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
                   "vehicle\n"
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
      "vehicle\n"
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
                    "auto_respawn = \"true\"; }\nscript \"go\" { start cmd \"logger\"; wait ms 12000; }\n");
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

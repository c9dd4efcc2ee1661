// Trials in real time with real programs on a private network: what is killed or halted comes back and the thrusters
// stop in time; where nobody brings it back the trial ends.
#include <doctest/doctest.h>

#include <algorithm>
#include <fathom_lcm/wrench_command_t.hpp>

#include "common/base/event_log.hpp"
#include "common/wire/log_reader.hpp"
#include "test/support/private_network.hpp"

namespace fathom {
namespace {

using test::on_a_network;
using test::private_network;
using test::Scratch;

constexpr double kLife = 0.5;  // s, of the vehicle's promise

bool pushes(const Thrusters& t) {
  return std::any_of(t.tau.begin(), t.tau.end(), [](double x) { return x != 0.0; });
}

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

}  // namespace

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
  Utime last_push = 0;
  for (const Thrusters& t : run.thrusters) {
    if (pushes(t)) last_push = t.utime;
  }
  REQUIRE(last_push > 0);
  const Utime died = last_command(scratch.path("trial.lcmlog.00"));
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
      "${programs}recorder --file trial.lcmlog 2>recorder.txt & r=$!\n"
      // Neutrally buoyant: without thrust it stays inside of its fence, however long all this takes.
      "sed 's/W-B: .*/W-B: 0 N/' $share/simulation/seabotix_lbv150.yaml >neutral.yaml\n"
      "${programs}simulator $operator --config neutral.yaml $site >simulator.txt 2>&1 &\n"
      "arm() { $fathom arm --operator $share/operators/simulated.yaml $*; }\n"
      "begins() { arm >begins.txt 2>&1; }; within 60 begins\n"
      "learns() { $fathom status | grep -q certainty; }; within 60 learns; sleep 2; kill -9 $i; kill -0 $i\n"
      "within 60 grep -q 'aborted: identifier is silent' supervisor.txt\n"
      "arm; echo \"listed $?\"; arm --needs estimator; echo \"refused $?\"\n"
      "speaks() { $fathom status | grep -q '^identifier .*running'; }; identify; within 60 speaks\n"
      "arm; echo \"armed $?\"; kill -INT $r; wait $r; cat supervisor.txt\n",
      240);
  CHECK_FALSE(ran.says("not within"));
  CHECK_MESSAGE(ran.says("aborted: identifier is silent: no HEALTH for 1"), ran.text);
  CHECK_MESSAGE(ran.says("NOT OK  identifier"), ran.text);
  CHECK(ran.says("listed 1"));
  CHECK(ran.says(
      "refused by supervisor: not armed: identifier is silent: no HEALTH for "));  // whoever goes past the list
  CHECK(ran.says("refused 1"));
  CHECK(ran.says("the sheriff's table tells why it does not run; then arm again"));
  CHECK_MESSAGE(ran.says("armed 0"), ran.text);
  const Recording run = wire::read_log(scratch.path("trial.lcmlog")).recording;
  const auto lost = std::find_if(run.excitation.begin(), run.excitation.end(), [](const Excitation& each) {
    return each.phase == "lost" && each.reason.starts_with("no thrust: identifier is silent");
  });
  const auto aborted = std::find_if(run.excitation.begin(), run.excitation.end(),
                                    [](const Excitation& each) { return each.phase == "aborted"; });
  REQUIRE(lost != run.excitation.end());
  REQUIRE(aborted != run.excitation.end());
  CHECK(seconds_between(run.model.front().utime, lost->utime) > 5.0);
  for (const Thrusters& each : run.thrusters) {
    if (seconds_between(lost->utime, each.utime) > kLife && each.utime < aborted->utime) CHECK_FALSE(pushes(each));
  }
  MESSAGE("no thrust " << seconds_between(lost->utime, aborted->utime) << " s before the abort");
}

}  // namespace fathom

// A live trial with its real processes against the simulator, in lockstep on a private network: it ends by itself, its
// log gives the same STATE and MODEL to the last bit, nothing moves before the operator's word, and an abort stops it.
#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>

#include "common/base/event_log.hpp"
#include "common/wire/log_reader.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/timing.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;
using test::Scratch;
using test::shell;

constexpr Utime kOrigin = 1'700'000'000'000'000;

const std::string kConfig = " --log-level warning --config " + file("config/pipelines/tank.yaml") + " --config " +
                            file("config/vehicles/seabotix_lbv150.yaml") + " --config " +
                            file("config/sites/tank.yaml") + " --config " + file("config/operators/simulated.yaml") +
                            " --config " + file("config/corrections/none.yaml");

bool private_network() {
  if (shell("unshare -rn ip link set lo up").code == 0) return true;
  MESSAGE("skipped: this machine allows no private network (unshare -rn)");
  return false;
}

test::Ran trial(const Scratch& scratch, const std::string& log, const std::string& options) {
  std::string script =
      "ip link set lo up; ip route add 224.0.0.0/4 dev lo; "
      "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0'\n";
  for (const char* mind : {"estimator", "identifier", "supervisor"}) {
    script += program(mind) + " --lockstep" + kConfig + " &\n";
  }
  script += program("recorder") + " --lockstep --file " + scratch.path(log) + " &\n";
  script += program("simulator") + " --log-level warning --config " + file("config/vehicles/seabotix_lbv150.yaml") +
            " --config " + file("config/sites/tank.yaml") + " --config " +
            file("config/simulation/seabotix_lbv150.yaml") + " --config " + file("config/operators/simulated.yaml") +
            " --speed 0 --wait-for estimator,identifier,supervisor,recorder " + options +
            "\ncode=\\$?\nwait\nexit \\$code";
  return shell(test::limit(60) + "unshare -rn sh -c \"" + script + "\"");
}

std::vector<std::string> messages(const std::string& path, const std::string& channel) {
  std::vector<std::string> found;
  EventLog log{path};
  while (const auto event = log.next()) {
    if (event->channel == channel) found.emplace_back(event->data.begin(), event->data.end());
  }
  return found;
}

double seconds(Utime utime) { return seconds_between(kOrigin, utime); }

}  // namespace

TEST_CASE(
    "trial: modes follow each other in the live set, and its log gives the same STATE and MODEL to the last bit") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = trial(scratch, "run.lcmlog", "--duration 75 --seed 4 --order 1=identify");
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const std::string run = scratch.path("run.lcmlog");
  const Recording live = wire::read_log(run).recording;
  REQUIRE(live.excitation.size() > 1000);
  CHECK(live.excitation.front().phase == "disarmed");
  std::vector<std::string> modes;
  for (const Excitation& e : live.excitation) {
    if (!e.mode.empty() && (modes.empty() || modes.back() != e.mode)) modes.push_back(e.mode);
  }
  REQUIRE(modes.size() >= 2);
  CHECK(modes[0] == "yaw");
  CHECK(modes[1] == "surge");
  CHECK(live.model.back().modes.size() == 5);
  CHECK(live.excitation.back().frozen.size() >= 3);
  // What was wished half a second before (freeze_delay) is obeyed.
  const Utime wished = utime_after(live.model.back().utime, -0.5);
  const auto behind = std::ranges::upper_bound(live.excitation, wished, {}, &Excitation::utime);
  REQUIRE(behind != live.excitation.begin());
  CHECK(live.model.back().frozen == std::prev(behind)->frozen);
  for (const Thrusters& t : live.thrusters) {
    if (seconds(t.utime) < 1.0) CHECK(std::all_of(t.tau.begin(), t.tau.end(), [](double x) { return x == 0.0; }));
  }

  const auto estimator =
      shell(program("estimator") + kConfig + " --in file://" + run + " --out file://" + scratch.path("state.lcmlog"));
  REQUIRE_MESSAGE(estimator.code == 0, estimator.text);
  CHECK(messages(scratch.path("state.lcmlog"), "STATE") == messages(run, "STATE"));
  const auto identifier =
      shell(program("identifier") + kConfig + " --in file://" + run + " --out file://" + scratch.path("model.lcmlog"));
  REQUIRE_MESSAGE(identifier.code == 0, identifier.text);
  CHECK(messages(scratch.path("model.lcmlog"), "MODEL") == messages(run, "MODEL"));
  CHECK(messages(scratch.path("model.lcmlog"), "RESIDUAL") == messages(run, "RESIDUAL"));
}

TEST_CASE("trial: an abort stops the thrusters at once and for good") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran =
      trial(scratch, "run.lcmlog", "--duration 15 --seed 4 --order 1=identify --order 8=abort --order 10=identify");
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const Recording live = wire::read_log(scratch.path("run.lcmlog")).recording;
  bool pushed = false;
  for (const Thrusters& t : live.thrusters) {
    const bool pushes = std::any_of(t.tau.begin(), t.tau.end(), [](double x) { return x != 0.0; });
    if (seconds(t.utime) < 7.9) pushed = pushed || pushes;
    if (seconds(t.utime) > 8.07) CHECK_FALSE(pushes);
  }
  CHECK(pushed);
  CHECK(live.excitation.back().phase == "aborted");
}

TEST_CASE("trial: a replayed log does not arm, and its orders are named") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = trial(scratch, "run.lcmlog", "--duration 4 --seed 4 --order 1=identify");
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  // A dry thruster driver hears the whole log again, commands and arming and all: its clock is the wall's.
  const std::string config = scratch.path("dry.yaml");
  test::shell("printf 'thruster_driver:\\n  protocol: dry_run\\n  rate: 20 Hz\\n  largest_thrust: 13 N\\n' > " +
              config);
  const auto replayed =
      shell(test::limit(30) +
            "unshare -rn sh -c \"ip link set lo up; ip route add 224.0.0.0/4 dev lo; "
            "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0'\n" +
            program("thruster_driver") + " --config " + config + " --config " + file("config/vehicles/bluerov2.yaml") +
            " --config " + file("config/operators/simulated.yaml") + " & driver=\\$!\nfor i in 1 2 3 4 5 6 7 8; do " +
            program("fathom") + " status | grep -q thruster_driver && break; done\nlcm-logplayer --speed=4 " +
            scratch.path("run.lcmlog") + " >/dev/null 2>&1\n" + program("fathom") + " status\nkill \\$driver\nwait\"");
  CHECK_MESSAGE(replayed.says("orders refused 1 (a replay: "), replayed.text);
  CHECK_MESSAGE(replayed.says("zero thrust: not armed"), replayed.text);
}

}  // namespace fathom

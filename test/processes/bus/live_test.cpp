// scripts/live as ./trial --live runs it: a trial from the first command to the page; and what goes wrong ends with one
// line, a code, and nothing left running.
#include "test/support/live.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include "common/base/event_log.hpp"
#include "common/wire/log_reader.hpp"
#include "test/support/schema.hpp"

namespace fathom {
namespace {

using test::file;
using test::live;
using test::live_network;
using test::nothing_left;
using test::program;
using test::result_of;
using test::Scratch;
using test::shell;

std::vector<std::string> messages(const std::string& path, const std::string& channel) {
  std::vector<std::string> found;
  EventLog log{path};
  while (const auto event = log.next()) {
    if (event->channel == channel) found.emplace_back(event->data.begin(), event->data.end());
  }
  return found;
}

// Starts a trial, does something to it once the log has begun, and waits for its end.
test::Ran disturbed(const Scratch& scratch, const std::string& words, const std::string& deed) {
  const std::string log = scratch.path("out/run.lcmlog");  // in real time a number is added to the name
  return shell(live(scratch, words) + " &\nscript=$!\nfor i in $(seq 400); do [ -s '" + log + "' ] || [ -s '" + log +
               ".00' ] && break; sleep 0.05; done\nsleep 0.5\n" + deed + "\nwait $script");
}

/// Until the supervisor has said so.
std::string await(const Scratch& scratch, const std::string& word) {
  return "for i in $(seq 400); do grep -qs " + word + " '" + scratch.path("out/processes/supervisor.txt") +
         "' && break; sleep 0.1; done\n";
}

std::string pid_of(const Scratch& scratch, const std::string& process) {
  return "$(pgrep -f '^[^ ]*fathom-" + process + " .*" + scratch.path("out") + "')";
}

}  // namespace

TEST_CASE("live: a trial that is cut short still gives table, result, page and truth, and leaves nothing running") {
  if (!live_network()) return;
  const Scratch scratch;
  const auto ran =
      shell("export FATHOM_LIVE_DIAGNOSE=yes\n" + live(scratch, "tank seabotix_lbv150 paper lockstep 1007 45"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  CHECK_MESSAGE(ran.says("Identified"), ran.text);
  CHECK_MESSAGE(ran.says("the loop closed on the log: "), ran.text);
  CHECK_MESSAGE(ran.says("mode"), ran.text);
  for (const char* name : {"run.lcmlog", "result.json", "report.html", "truth.json", "pipeline.yaml",
                           "diagnosis/result.json", "diagnosis/report.html"}) {
    CHECK_MESSAGE(std::filesystem::file_size(scratch.path(std::string{"out/"} + name)) > 0, name);
  }
  const auto result = result_of(scratch);
  CHECK(result["parameters"].size() == 13);
  CHECK(result["settled"] == false);
  CHECK(result["closed_loop"]["report"] == "diagnosis/report.html");
  CHECK(result["modes"].size() >= 1);
  CHECK(result["modes"][0]["mode"] == "yaw");
  CHECK(result["compared_with_truth"]["states_compared"].get<int>() > 500);
  CHECK(result["files"][0]["role"] == "log");
  CHECK(test::against_schema(scratch, scratch.path("out/result.json"), "live_trial-1") == "");
  CHECK(test::against_schema(scratch, scratch.path("out/diagnosis/result.json"), "diagnosis-2") == "");
  const std::string page = test::read_bytes(scratch.path("out/report.html"));
  for (const char* words : {"Table 1.1", "Figure 1.11", "Figure 1.12", "Figure 1.13", "Figure 1.14", "Figure 1.15",
                            "Figure 1.16", "Figure 1.19", "None of the processes heard"}) {
    CHECK_MESSAGE(page.find(words) != std::string::npos, words);
  }
  for (const char* word : {"http:", "https:", "src=", "<script"}) CHECK(page.find(word) == std::string::npos);
  CHECK(nothing_left(scratch));
}

TEST_CASE("live: a vehicle that rolls easily learns that too, and is not tilted out of its envelope") {
  if (!live_network()) return;
  const Scratch scratch;
  const auto ran = shell(live(scratch, "tank bluerov2 optimal lockstep 1 100"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const auto result = result_of(scratch);
  CHECK_MESSAGE((result["phase"] == "excite" || result["phase"] == "done"), ran.text);
  double roll = 0.0;
  for (const StateEstimate& each : wire::read_log(scratch.path("out/run.lcmlog")).recording.state) {
    roll = std::max(roll, std::abs(each.nu[3]));
  }
  CHECK(roll > 0.3);  // rad/s
}

TEST_CASE("live: in real time, with the recorder") {
  if (!live_network()) return;
  const Scratch scratch;
  const auto ran = shell(live(scratch, "deep seabotix_lbv150 optimal real 1008 12"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const auto result = result_of(scratch);
  CHECK(result["modes"][0]["mode"] == "total");
  CHECK(result["compared_with_truth"]["states_compared"].get<int>() > 50);
  CHECK(nothing_left(scratch));
}

TEST_CASE("live: byte-true through every driver, the same vehicle is identified") {
  if (!live_network()) return;
  const Scratch scratch, plain;
  const auto ran = shell(live(scratch, "tank seabotix_lbv150 optimal bytes 1008 35"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  CHECK(nothing_left(scratch));
  const Recording run = wire::read_log(scratch.path("out/run.lcmlog")).recording;
  CHECK(run.ahrs.size() > 33 * 100);
  CHECK(run.depth.size() > 33 * 20);
  CHECK(run.loads.size() > 33 * 10);
  CHECK(run.thrusters.size() > 33 * 50);
  // The host's stamps against the instrument's truth: AHRS is taken every 10 ms, half of that after the run's start.
  std::ifstream text{scratch.path("out/truth.json")};
  const Utime origin = nlohmann::json::parse(text)["origin_utime"].get<Utime>();
  std::vector<double> off;
  for (const Ahrs& sample : run.ahrs) {
    off.push_back(std::abs(std::remainder(seconds_between(origin, sample.utime) - 0.005, 0.01)));
  }
  std::nth_element(off.begin(), off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2), off.end());
  CHECK(off[off.size() / 2] < 1.1e-3);  // its clock tells whole milliseconds

  const auto again = shell(live(plain, "tank seabotix_lbv150 optimal lockstep 1008 35"));
  REQUIRE_MESSAGE(again.code == 0, again.text);
  const auto compared = shell(program("fathom") + " compare --intervals '" + scratch.path("out/run.lcmlog") + "' '" +
                              plain.path("out/run.lcmlog") + "'");
  // Of thirteen pairs of 95 % intervals one may miss by chance.
  CHECK_MESSAGE((compared.says("13 of 13 parameters agree") || compared.says("12 of 13 parameters agree")),
                compared.text);
}

TEST_CASE("live: what cannot be played is said in one line") {
  const Scratch scratch;
  const auto refused = [&](const std::string& section, const char* words) {
    std::ofstream{scratch.path("x.yaml")} << section;
    const auto ran =
        shell(program("simulator") + " --config " + file("config/vehicles/seabotix_lbv150.yaml") + " --config " +
              file("config/sites/tank.yaml") + " --config " + file("config/simulation/seabotix_lbv150.yaml") +
              " --config " + file("config/operators/simulated.yaml") + " --bytes " + scratch.path("x.yaml"));
    CHECK(ran.code == 1);
    CHECK(ran.lines() == 1);
    CHECK_MESSAGE(ran.says(words), ran.text);
  };
  refused("depth_driver: {protocol: ms5837, link: 'i2c:///dev/i2c-1'}", "use nmea_depth");
  refused("ahrs_driver: {protocol: ig500, link: 'udp://:7000', rotation: 0 0 0 deg}", "serial:///PATH?baud=N");
  refused("ahrs_driver: {protocol: ig500, link: 'serial:///proc/x?baud=9600', rotation: 0 0 0 deg}", "/proc/x");
  refused("thruster_driver: {protocol: dry_run}", "use motor_test or text");
  refused("thruster_driver: {protocol: rc_override, link: 'serial://" + scratch.path("tty") + "?baud=115200'}",
          "has no thrust curve; use text");
  refused("thruster_driver: {protocol: motor_test, link: 'tcp://127.0.0.1:0'}", "");
  refused("{}", "no driver of an instrument");
}

TEST_CASE(
    "live: an effect that the simulator draws and hides is adopted, listed in MODEL, and the log gives the same bits") {
  if (!live_network()) return;
  const std::vector<std::string> effects{"current", "asymmetric_drag", "thrust_asymmetry"};
  std::mt19937 draw{20261121};
  const std::string& hidden = effects[draw() % effects.size()];
  const std::string seed = std::to_string(1000 + draw() % 1000);
  CAPTURE(hidden);
  CAPTURE(seed);
  const Scratch scratch;
  const auto ran = shell(live(scratch, "tank seabotix_lbv150 optimal lockstep " + seed + " 190 --hide " + hidden));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const auto result = result_of(scratch);
  CHECK_MESSAGE(result["adopted_effects"] == nlohmann::json::array({hidden}), ran.text);
  CHECK(result["effect_parameters"].size() >= 1);
  CHECK(result["compared_with_truth"]["hidden_effects"] == nlohmann::json::array({hidden}));

  const auto again = shell(
      program("identifier") + " --log-level warning --config '" + scratch.path("out/pipeline.yaml") + "' --config " +
      file("config/vehicles/seabotix_lbv150.yaml") + " --config " + file("config/corrections/none.yaml") +
      " --in file://" + scratch.path("out/run.lcmlog") + " --out file://" + scratch.path("model.lcmlog"));
  REQUIRE_MESSAGE(again.code == 0, again.text);
  CHECK(messages(scratch.path("model.lcmlog"), "MODEL") == messages(scratch.path("out/run.lcmlog"), "MODEL"));
}

TEST_CASE("live: with the joint estimate a trial settles sooner, and the log gives the same bits") {
  if (!live_network()) return;
  const Scratch scratch;
  const auto ran =
      shell("FATHOM_LIVE_ESTIMATE=joint " + live(scratch, "tank seabotix_lbv150 optimal lockstep 1011 100"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const auto result = result_of(scratch);
  CHECK_MESSAGE(result["settled"] == true, ran.text);
  CHECK(result["parameters"].size() == 13);
  const auto again =
      shell(program("identifier") + " --log-level warning --config '" + scratch.path("out/pipeline.yaml") +
            "' --config " + file("config/vehicles/seabotix_lbv150.yaml") + " --config " +
            file("config/corrections/none.yaml") + " --config " + file("config/sites/tank.yaml") + " --in file://" +
            scratch.path("out/run.lcmlog") + " --out file://" + scratch.path("model.lcmlog"));
  REQUIRE_MESSAGE(again.code == 0, again.text);
  CHECK(messages(scratch.path("out/run.lcmlog"), "MODEL").size() > 40);
  CHECK(messages(scratch.path("model.lcmlog"), "MODEL") == messages(scratch.path("out/run.lcmlog"), "MODEL"));
  CHECK(messages(scratch.path("model.lcmlog"), "RESIDUAL") == messages(scratch.path("out/run.lcmlog"), "RESIDUAL"));

  // Without the site, or beside another filter, it is refused with one line.
  const auto refused =
      shell(program("identifier") + " --config '" + scratch.path("out/pipeline.yaml") + "' --config " +
            file("config/vehicles/seabotix_lbv150.yaml") + " --config " + file("config/corrections/none.yaml") +
            " --in file://" + scratch.path("out/run.lcmlog") + " --out file://" + scratch.path("refused.lcmlog"));
  CHECK(refused.code == 1);
  CHECK_MESSAGE(refused.says("site"), refused.text);
}

TEST_CASE("live: an identifier that falls silent is started again, goes on with what it knew, and the trial goes on") {
  if (!live_network()) return;
  const Scratch scratch;
  const auto ran = disturbed(scratch, "tank seabotix_lbv150 optimal real 3 26",
                             await(scratch, "excite") + "sleep 4; kill -STOP " + pid_of(scratch, "identifier"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const std::string said = test::read_bytes(scratch.path("out/processes/identifier.txt"));
  CHECK_MESSAGE(said.find(" s and does nothing; killed, to be started again") != std::string::npos, said);
  CHECK_MESSAGE(said.find("goes on from ") != std::string::npos, said);
  CHECK(result_of(scratch)["phase"] == "excite");
  CHECK(nothing_left(scratch));
}

TEST_CASE("live: when the estimator or the supervisor falls silent, the thrusters stop within a second") {
  if (!live_network()) return;
  for (const std::string victim : {"estimator", "supervisor"}) {
    CAPTURE(victim);
    const Scratch scratch;
    const auto ran = disturbed(scratch, "tank seabotix_lbv150 paper real 3 18",
                               await(scratch, "approach") + "sleep 3; kill -STOP " + pid_of(scratch, victim));
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    const Recording run = wire::read_log(scratch.path("out/run.lcmlog")).recording;
    // The last word before the silence, which lasts until the deputy starts another one.
    std::vector<Utime> words;
    for (const StateEstimate& each : run.state) words.push_back(each.utime);
    if (victim == "supervisor") {
      words.clear();
      for (const WrenchCommand& each : run.wrench_command) words.push_back(each.utime);
    }
    REQUIRE(!words.empty());
    words.push_back(run.thrusters.back().utime);
    const auto gap =
        std::adjacent_find(words.begin(), words.end(), [](Utime a, Utime b) { return seconds_between(a, b) > 2.0; });
    REQUIRE_MESSAGE(gap != words.end(), test::read_bytes(scratch.path("out/processes/sheriff.txt")));
    const Utime heard = *gap;
    bool pushed = false;
    Utime last_push = 0;
    for (const Thrusters& t : run.thrusters) {
      const bool pushes = std::any_of(t.tau.begin(), t.tau.end(), [](double x) { return x != 0.0; });
      const double after = seconds_between(heard, t.utime);
      pushed = pushed || (pushes && after < 0.0);
      if (pushes && after < 2.0) last_push = t.utime;
    }
    CHECK(pushed);
    CHECK(seconds_between(run.thrusters.front().utime, heard) > 5.0);
    CHECK(seconds_between(heard, last_push) < 1.0);
    CHECK(nothing_left(scratch));
  }
}

TEST_CASE("live: an attitude sensor without numbers is named by HEALTH, the thrusters stop, and the log is whole") {
  if (!live_network()) return;
  const Scratch scratch;
  const auto ran = shell(live(scratch, "tank seabotix_lbv150 paper real 3 16 --fail ahrs=nan,from:9"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const Recording run = wire::read_log(scratch.path("out/run.lcmlog")).recording;
  CHECK(std::ranges::any_of(run.health, [](const Health& each) {
    return each.process == "estimator" && each.state == "unhealthy" && each.detail.find("AHRS is silent") == 0;
  }));
  const Utime begin = run.thrusters.front().utime;
  double last_push = 0.0;
  for (const Thrusters& each : run.thrusters) {
    if (std::ranges::any_of(each.tau, [](double x) { return x != 0.0; }))
      last_push = seconds_between(begin, each.utime);
  }
  CHECK(last_push > 8.0);
  CHECK(last_push < 10.0);  // a command's life is 0.3 s
  CHECK(seconds_between(begin, run.thrusters.back().utime) > 15.0);
}

TEST_CASE("live: an instrument whose clock goes back is named, and the trial goes on without it") {
  if (!live_network()) return;
  const Scratch scratch;
  const auto ran = shell(live(scratch, "deep seabotix_lbv150 paper lockstep 3 40 --fail usbl=jump,from:25,to:31"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const Recording run = wire::read_log(scratch.path("out/run.lcmlog")).recording;
  CHECK(std::ranges::none_of(run.excitation, [](const auto& each) { return each.phase == "lost"; }));
  CHECK(run.excitation.back().phase == "excite");
  CHECK(std::ranges::any_of(run.health, [](const Health& each) {
    return each.process == "estimator" && each.detail.find("USBL comes") != std::string::npos;
  }));
  CHECK_MESSAGE(
      test::read_bytes(scratch.path("out/processes/estimator.txt")).find("starting over") == std::string::npos,
      "the estimator started over");
}

TEST_CASE("live: a process that dies ends the trial with one line that names it") {
  if (!live_network()) return;
  for (const char* victim : {"identifier", "simulator", "recorder"}) {
    CAPTURE(victim);
    const Scratch scratch;
    const auto ran =
        disturbed(scratch, "tank seabotix_lbv150 paper lockstep 1 1500", "kill -KILL " + pid_of(scratch, victim));
    CHECK(ran.code == 1);
    CHECK_MESSAGE(ran.says(std::string{victim} + " on trial failed: Killed"), ran.text);
    CHECK(nothing_left(scratch));
  }
}

TEST_CASE("live: Ctrl-C stops everything") {
  if (!live_network()) return;
  const Scratch scratch;
  const auto ran = disturbed(scratch, "tank seabotix_lbv150 paper lockstep 1 1500", "kill -INT $script");
  CHECK_MESSAGE(ran.code == 130, ran.text);
  CHECK_MESSAGE(ran.says("stopped; what there is lies in"), ran.text);
  CHECK(nothing_left(scratch));
}

TEST_CASE("live: what cannot start says why") {
  if (!live_network()) return;
  const Scratch scratch;
  const auto ran = shell(live(scratch, "tank seabotix_lbv150 paper lockstep 1 20 --hide sea_monster"));
  CHECK(ran.code == 1);
  CHECK_MESSAGE(ran.says("sea_monster"), ran.text);
  CHECK_MESSAGE(ran.lines() <= 3, ran.text);  // what is begun, why it ended, where to look
  CHECK(nothing_left(scratch));
}

}  // namespace fathom

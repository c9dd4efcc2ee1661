// The sheriff's mind, its scripts and its table, against the deputy's mind in the same virtual time.
#include <doctest/doctest.h>

#include <csignal>

#include "common/launch/deputy.hpp"
#include "common/launch/script_run.hpp"
#include "common/launch/table.hpp"

namespace fathom::launch {
namespace {

constexpr Utime kWall = 1'700'000'000'000'000;
constexpr double kStep = 0.1;  // s of virtual time

constexpr char kText[] = R"(
group "minds" {
  cmd "a" { exec = "prog-a"; deputy = "vehicle"; auto_respawn = "true"; }
  cmd "b" { exec = "prog-b"; deputy = "vehicle"; }
}
cmd "c" { exec = "prog-c"; deputy = "topside"; }
script "go" { start group "minds" wait "running"; wait ms 500; start cmd "c"; }
script "wait" { start cmd "b" wait "running"; wait cmd "b" status "stopped"; start cmd "c"; }
script "stop" { stop everything wait "stopped"; }
)";

/// Two hosts; programs obey at once unless named in `stubborn`.
struct World {
  LaunchConfig config{LaunchConfig::parse(kText, "x.cfg")};
  Sheriff sheriff{"s:1", config};
  std::map<std::string, Deputy> deputies{{"vehicle", Deputy{"vehicle"}}, {"topside", Deputy{"topside"}}};
  std::map<std::string, std::int32_t> fails{};  ///< program: how it ends at once
  double now{50.0};
  std::int32_t pid{100};
  int starts{};

  void carry_out(Deputy& deputy) {
    for (auto acts = deputy.take_acts(); !acts.empty(); acts = deputy.take_acts()) {
      for (const Act& act : acts) {
        if (act.kind == Act::Kind::kStart) {
          ++starts;
          deputy.started(act.id, ++pid, now);
          if (fails.contains(act.id)) deputy.died(act.id, fails[act.id], now);
        }
        if (act.kind == Act::Kind::kSignal && act.signal == SIGINT) deputy.died(act.id, SIGINT, now);
      }
    }
  }
  void step(double seconds) {
    for (const double end = now + seconds; now < end; now += kStep) {
      for (const LaunchOrders& orders : sheriff.orders(kWall)) {
        if (!deputies.contains(orders.deputy)) continue;
        deputies.at(orders.deputy).hear(orders, kWall, now);
      }
      for (auto& [name, deputy] : deputies) {
        deputy.tick(now);
        carry_out(deputy);
        sheriff.hear(deputy.info(kWall), kWall, now);
      }
    }
  }
  [[nodiscard]] Sheriff::Row row(const std::string& id) const {
    return sheriff.rows({Target::Kind::kCommand, id}, now).at(0);
  }
  ScriptRun::Result run(ScriptRun& script, double limit) {
    auto result = script.step(now);
    for (const double end = now + limit; now < end && result == ScriptRun::Result::kGoing; result = script.step(now)) {
      step(kStep);
    }
    return result;
  }
};

Target command(const std::string& id) { return {Target::Kind::kCommand, id}; }

}  // namespace

TEST_CASE("sheriff: looking on orders nothing, so that it stops nothing") {
  World world;
  world.step(1.0);
  CHECK(world.sheriff.orders(kWall).empty());
  CHECK(world.row("a").state == State::kIdle);
  CHECK(world.sheriff.complaints(world.now).empty());
}

TEST_CASE("sheriff: starts, restarts and stops, and says so in procman's states") {
  World world;
  CHECK(world.row("a").state == State::kUnheard);
  world.step(0.5);
  world.sheriff.start(command("a"));
  CHECK(world.sheriff.take_changed());
  CHECK(world.row("a").state == State::kStarting);
  world.step(0.5);
  CHECK(world.row("a").state == State::kRunning);
  CHECK(world.row("b").state == State::kIdle);
  const auto before = world.row("a").status.pid;
  world.sheriff.start(command("a"));
  world.step(0.5);
  CHECK(world.row("a").status.pid == before);
  world.sheriff.restart(command("a"));
  CHECK(world.row("a").state == State::kRestarting);
  world.step(1.0);
  CHECK(world.row("a").state == State::kRunning);
  CHECK(world.row("a").status.pid != before);
  world.sheriff.stop(command("a"));
  CHECK(world.row("a").state == State::kStopping);
  world.step(0.5);
  CHECK(world.row("a").state == State::kStopped);
  CHECK(world.sheriff.complaints(world.now).empty());
}

TEST_CASE("sheriff: a second one adopts what runs, with its number, and stops none of it") {
  World world;
  world.step(0.5);
  world.sheriff.start(command("a"));
  world.sheriff.restart(command("a"));
  world.step(1.0);
  REQUIRE(world.row("a").status.run == 2);
  const auto pid = world.row("a").status.pid;
  // The newcomer's configuration knows nothing of a.
  world.sheriff = Sheriff{"s:2", LaunchConfig::parse("cmd \"z\" { exec = \"zz\"; deputy = \"vehicle\"; }\n", "z.cfg")};
  world.step(0.5);
  CHECK(world.row("a").foreign);
  CHECK(world.row("a").state == State::kRunning);
  world.sheriff.start(command("z"));
  world.step(1.0);
  CHECK(world.row("a").status.pid == pid);
  CHECK(world.row("z").state == State::kRunning);
  world.sheriff.stop({});
  world.step(1.0);
  CHECK(world.row("a").state == State::kStopped);
  CHECK(world.row("z").state == State::kStopped);
}

TEST_CASE("sheriff: a program that runs with another command line is named") {
  World world;
  world.step(0.5);
  world.sheriff.start(command("a"));
  world.step(0.5);
  world.sheriff =
      Sheriff{"s:2", LaunchConfig::parse("cmd \"a\" { exec = \"prog-a --new\"; deputy = \"vehicle\"; }\n", "y.cfg")};
  world.step(0.5);
  world.sheriff.start(command("a"));
  world.step(0.5);
  REQUIRE(world.sheriff.complaints(world.now).size() == 1);
  CHECK(world.sheriff.complaints(world.now).front() ==
        "a on vehicle runs with another command line than y.cfg says; restart it");
  world.sheriff.restart(command("a"));
  world.step(1.5);
  CHECK(world.sheriff.complaints(world.now).empty());
}

TEST_CASE("sheriff: what failed, and what shall run and does not, is a complaint; what ended well is none") {
  World world;
  world.step(0.5);
  world.fails = {{"b", 768}};
  world.sheriff.start(command("b"));
  world.step(1.0);
  CHECK(world.row("b").state == State::kFailed);
  CHECK(world.sheriff.complaints(world.now) == std::vector<std::string>{"b on vehicle failed: exit 3"});
  CHECK(world.starts == 1);
  world.fails = {{"b", 0}};
  world.sheriff.start(command("b"));
  world.step(1.0);
  CHECK(world.starts == 2);
  CHECK(world.row("b").state == State::kStopped);
  CHECK(world.sheriff.complaints(world.now).empty());
  world.fails = {{"a", 11}};
  world.sheriff.start(command("a"));
  world.step(5.0);
  CHECK(world.starts > 5);
  REQUIRE(world.sheriff.complaints(world.now).size() == 1);
  CHECK(world.sheriff.complaints(world.now).front().starts_with("a on vehicle"));
}

TEST_CASE("sheriff: a program that dies again and again is a complaint, though it runs at this moment; once is none") {
  World world;
  world.step(0.5);
  world.sheriff.start(command("a"));
  world.step(0.5);
  const auto die = [&] {
    world.deputies.at("vehicle").died("a", 256, world.now);
    world.sheriff.hear(world.deputies.at("vehicle").info(kWall), kWall, world.now);
    world.step(0.5);
    CHECK(world.row("a").state == State::kRunning);
  };
  die();
  CHECK(world.sheriff.complaints(world.now).empty());
  die();
  CHECK(world.sheriff.complaints(world.now) ==
        std::vector<std::string>{"a on vehicle keeps failing, 2 times in 10 s: exit 1"});
  world.step(11.0);
  CHECK(world.sheriff.complaints(world.now).empty());
}

TEST_CASE("sheriff: a deputy that falls silent is lost after five seconds, and back with its next word") {
  World world;
  world.step(0.5);
  world.sheriff.start(command("c"));
  world.step(0.5);
  const Deputy topside = world.deputies.at("topside");
  world.deputies.erase("topside");
  world.step(4.0);
  CHECK(world.row("c").state == State::kRunning);
  world.step(2.0);
  CHECK(world.row("c").state == State::kLost);
  CHECK(world.sheriff.unheard_deputies(world.now) == std::vector<std::string>{"topside"});
  CHECK(world.sheriff.complaints(world.now).size() == 1);
  world.deputies.emplace("topside", topside);
  world.step(0.5);
  CHECK(world.row("c").state == State::kRunning);
}

TEST_CASE("sheriff: a deputy that comes back without memory is given its work again, but not what was finished") {
  World world;
  world.step(0.5);
  world.sheriff.start(command("a"));
  world.sheriff.start(command("b"));
  world.step(0.5);
  world.deputies.at("vehicle").died("b", 0, world.now);
  world.step(0.5);
  world.deputies.at("vehicle") = Deputy{"vehicle"};
  world.step(1.0);
  CHECK(world.row("a").state == State::kRunning);
  CHECK(world.row("b").status.pid == 0);
  CHECK(world.starts == 3);
}

TEST_CASE("sheriff: another sheriff's orders are noticed for a while, its own are not") {
  World world;
  world.sheriff.hear(LaunchOrders{.sheriff = "s:1"}, 1.0);
  CHECK(world.sheriff.rival(1.0).empty());
  world.sheriff.hear(LaunchOrders{.sheriff = "s:9"}, 1.0);
  CHECK(world.sheriff.rival(2.0) == "s:9");
  CHECK(world.sheriff.rival(9.0).empty());
}

TEST_CASE("sheriff: an old word of a deputy is not believed") {
  World world;
  world.sheriff.hear(DeputyInfo{.utime = utime_after(kWall, -31.0), .deputy = "vehicle"}, kWall, world.now);
  CHECK(world.row("a").state == State::kUnheard);
}

TEST_CASE("script: runs its actions in order and is done") {
  World world;
  world.step(0.5);
  ScriptRun script{world.sheriff, world.config.require_script("go")};
  CHECK(world.run(script, 0.3) == ScriptRun::Result::kGoing);
  CHECK(world.row("a").state == State::kRunning);
  CHECK(world.row("c").state == State::kIdle);
  CHECK(world.run(script, 5.0) == ScriptRun::Result::kDone);
  world.step(0.5);
  CHECK(world.row("c").state == State::kRunning);
  ScriptRun stop{world.sheriff, world.config.require_script("stop")};
  CHECK(world.run(stop, 5.0) == ScriptRun::Result::kDone);
  CHECK(world.row("a").state == State::kStopped);
}

TEST_CASE("script: a program that fails at once does not pass for running") {
  World world;
  world.step(0.5);
  world.fails = {{"b", 256}};
  ScriptRun script{world.sheriff, world.config.require_script("go")};
  CHECK(world.run(script, 5.0) == ScriptRun::Result::kFailed);
  CHECK(script.text() == "x.cfg:7: b failed: exit 1");
  CHECK(world.row("c").state == State::kIdle);
}

TEST_CASE("script: ends when another program that it started is killed, but not when that one was asked to end") {
  World world;
  world.step(0.5);
  world.sheriff.start(command("c"));
  world.step(0.5);
  ScriptRun script{world.sheriff, world.config.require_script("wait")};
  CHECK(world.run(script, 5.0) == ScriptRun::Result::kGoing);
  world.deputies.at("topside").died("c", SIGKILL, world.now);
  CHECK(world.run(script, 5.0) == ScriptRun::Result::kFailed);
  CHECK(script.text() == "x.cfg:8: c failed: Killed");

  World asked;
  asked.step(0.5);
  asked.sheriff.start(command("c"));
  asked.step(0.5);
  asked.sheriff.stop(command("c"));
  ScriptRun other{asked.sheriff, asked.config.require_script("wait")};
  CHECK(asked.run(other, 5.0) == ScriptRun::Result::kGoing);
  CHECK(asked.row("c").state == State::kStopped);
}

TEST_CASE("script: a program that speaks runs when it has spoken, or after ten seconds all the same") {
  World world;
  world.step(0.5);
  bool spoken = false;
  const auto ready = [&](const Sheriff::Row& row) { return row.command.id != "a" || spoken; };
  ScriptRun script{world.sheriff, world.config.require_script("go"), ScriptRun::Care::kGiveUp, ready};
  CHECK(world.run(script, 5.0) == ScriptRun::Result::kGoing);
  CHECK(world.row("a").state == State::kRunning);
  CHECK(world.row("c").state == State::kIdle);
  spoken = true;
  CHECK(world.run(script, 2.0) == ScriptRun::Result::kDone);

  World silent;
  silent.step(0.5);
  ScriptRun patient{silent.sheriff, silent.config.require_script("go"), ScriptRun::Care::kGiveUp,
                    [](const Sheriff::Row&) { return false; }};
  CHECK(silent.run(patient, 9.0) == ScriptRun::Result::kGoing);
  CHECK(silent.run(patient, 5.0) == ScriptRun::Result::kDone);
}

TEST_CASE("script: waits as long as it takes for an end, but not for a silent deputy") {
  World world;
  world.step(0.5);
  ScriptRun script{world.sheriff, world.config.require_script("wait")};
  CHECK(world.run(script, 200.0) == ScriptRun::Result::kGoing);
  CHECK(script.text() == "waits until b has stopped");
  world.deputies.at("vehicle").died("b", 0, world.now);
  CHECK(world.run(script, 5.0) == ScriptRun::Result::kDone);

  World lost;
  lost.step(0.5);
  ScriptRun waiting{lost.sheriff, lost.config.require_script("wait")};
  CHECK(lost.run(waiting, 1.0) == ScriptRun::Result::kGoing);
  lost.deputies.erase("vehicle");
  CHECK(lost.run(waiting, 60.0) == ScriptRun::Result::kFailed);
  CHECK(waiting.text() == "x.cfg:8: deputy vehicle is silent; is it running and the link up?");
}

TEST_CASE("script: a stop goes on past a silent deputy and says so at the end") {
  World world;
  world.step(0.5);
  world.sheriff.start(command("a"));
  world.step(0.5);
  world.deputies.erase("topside");
  world.step(6.0);
  const LaunchConfig stop = LaunchConfig::parse(
      std::string{kText} + "script \"all\" { stop cmd \"c\" wait \"stopped\"; stop cmd \"a\" wait \"stopped\"; }\n",
      "x.cfg");
  ScriptRun script{world.sheriff, stop.require_script("all"), ScriptRun::Care::kGoOn};
  CHECK(world.run(script, 10.0) == ScriptRun::Result::kFailed);
  CHECK(script.text() == "x.cfg:10: deputy topside is silent; is it running and the link up?");
  CHECK(world.row("a").state == State::kStopped);
}

TEST_CASE("table: shows state, share of the processor, memory and health, and cuts long lines") {
  World world;
  world.step(0.5);
  world.sheriff.start(command("a"));
  world.step(0.5);
  world.deputies.at("vehicle").uses("a", {.cpu = 0.25F, .resident_memory = 12'000'000}, world.now);
  world.step(0.2);
  HealthBoard board;
  const auto pid = world.row("a").status.pid;
  board.hear({.process = "a", .host = "h", .pid = pid, .state = "unhealthy", .detail = "no tags\033[2J"}, world.now);
  board.hear({.process = "stranger", .host = "h", .pid = pid + 1, .state = "running"}, world.now);
  const std::string text = table(world.sheriff.rows(world.now), board, world.now, 200);
  CHECK(text.find("a        vehicle  running       25 %     12 MB  unhealthy  no tags?[2J\n") != std::string::npos);
  CHECK(board.of(world.row("a"), world.now + 4.0).state == "silent");
  board.hear({.process = "a",
              .host = "h",
              .pid = pid,
              .state = "running",
              .channels = {{"AHRS", 99.7, 0.01}, {"OPERATOR", 0.0, 40.0}, {"DEPTH", 20.0, 0.05}}},
             world.now);
  CHECK(table(world.sheriff.rows(world.now), board, world.now, 200).find("running    AHRS 100/s, DEPTH 20/s\n") !=
        std::string::npos);
  CHECK(table(world.sheriff.rows(world.now), board, world.now, 20).find("unhealthy") == std::string::npos);
  const std::string before = gist(world.sheriff.rows(world.now), board, world.now);
  CHECK(before == gist(world.sheriff.rows(world.now), board, world.now + 1.0));
  CHECK(before != gist(world.sheriff.rows(world.now), board, world.now + 4.0));
}

}  // namespace fathom::launch

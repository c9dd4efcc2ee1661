// The deputy's mind: what an order, a death, silence or time makes it do.
#include "common/launch/deputy.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <utility>

#include "common/base/error.hpp"
#include "test/support/scratch.hpp"

namespace fathom::launch {
namespace {

constexpr Utime kWall = 1'700'000'000'000'000;
constexpr std::int32_t kExit3 = 768;        // wait status of exit(3)
constexpr std::int32_t kSegmentation = 11;  // and of a segmentation fault
constexpr double kMicrosecond = 1e-6;       // s, of rounding in sums of delays

/// Carries out what the deputy wants, in virtual time.
struct Host {
  Deputy deputy{"vehicle"};
  double now{100.0};
  std::int32_t next_pid{1000};
  int starts{};
  std::vector<int> signals{};
  std::string said{};

  void act() {
    for (const Act& act : deputy.take_acts()) {
      if (act.kind == Act::Kind::kStart) {
        ++starts;
        deputy.started(act.id, ++next_pid, now);
      } else if (act.kind == Act::Kind::kSignal) {
        if (act.signal != SIGCONT) signals.push_back(act.signal);
      } else {
        said += act.id + ": " + act.text;
      }
    }
  }
  void order(std::int32_t run, bool stop = false, bool respawn = false, const std::string& deputy_id = "vehicle",
             double age = 0.0) {
    deputy.hear({.utime = utime_after(kWall, -age),
                 .deputy = deputy_id,
                 .sheriff = "s",
                 .commands = {{{.id = "a", .exec = "prog", .group = "g", .auto_respawn = respawn}, run, stop}}},
                kWall, now);
    act();
  }
  void die(std::int32_t wait_status) {
    deputy.died("a", wait_status, now);
    act();
  }
  void wait(double seconds) {
    now += seconds;
    deputy.tick(now);
    act();
  }
  [[nodiscard]] CommandStatus status() const { return deputy.info(kWall).commands.at(0); }
};

}  // namespace

TEST_CASE("deputy: a new run number starts, the same again does nothing") {
  Host host;
  host.order(1);
  CHECK(host.starts == 1);
  CHECK(host.status().pid == 1001);
  CHECK(host.status().run == 1);
  CHECK(host.deputy.take_changed());
  host.order(1);
  CHECK(host.starts == 1);
  CHECK_FALSE(host.deputy.take_changed());
}

TEST_CASE("deputy: any other number starts what is stopped, lower, negative and zero too") {
  for (const std::int32_t run : {4, -2, 0}) {
    Host host;
    host.order(5);
    host.die(0);
    host.order(run);
    CHECK(host.starts == 2);
    CHECK(host.status().run == run);
  }
  Host host;
  host.order(0);
  CHECK(host.starts == 0);  // as unstarted it is
}

TEST_CASE("deputy: a restart stops, and starts with the next order after the death") {
  Host host;
  host.order(1);
  host.order(2);
  CHECK(host.signals == std::vector<int>{SIGINT});
  CHECK(host.status().run == 1);
  host.order(2);
  CHECK(host.signals.size() == 1);
  host.die(0);
  CHECK(host.starts == 1);
  host.order(2);
  CHECK(host.starts == 2);
  CHECK(host.status().run == 2);
}

TEST_CASE("deputy: a stop is obeyed, not repeated, and not undone by respawning") {
  Host host;
  host.order(1, false, true);
  host.order(1, true, true);
  host.order(1, true, true);
  CHECK(host.signals == std::vector<int>{SIGINT});
  host.die(SIGINT);
  host.wait(5.0);
  CHECK(host.starts == 1);
  CHECK(host.status().pid == 0);
  CHECK(host.status().run == 1);
  CHECK(host.said.empty());  // it was asked to
  host.order(1, false, true);
  CHECK(host.starts == 1);  // clearing the stop alone starts nothing
}

TEST_CASE("deputy: what does not stop in its time is killed without a further order") {
  Host host;
  host.order(1);
  host.order(1, true);
  host.wait(6.9);
  CHECK(host.signals.size() == 1);
  CHECK(host.deputy.idle(host.now) < 0.11);
  host.wait(0.2);
  CHECK(host.signals == std::vector<int>{SIGINT, SIGKILL});
  host.wait(0.5);
  CHECK(host.signals.size() == 2);
  host.wait(0.6);
  CHECK(host.signals.size() == 3);  // still there: again
  host.die(SIGKILL);
  host.wait(5.0);
  CHECK(host.signals.size() == 3);
}

TEST_CASE("deputy: orders for others, old ones and empty names change nothing") {
  Host host;
  host.order(1, false, false, "topside");
  CHECK(host.deputy.info(kWall).commands.empty());
  host.order(1, false, false, "vehicle", 61.0);
  CHECK(host.starts == 0);
  CHECK(host.said.find("a: ignoring stale orders, 61 s old") != std::string::npos);
  host.deputy.hear({.utime = kWall, .deputy = "vehicle", .sheriff = "s", .commands = {{{}, 1, false}}}, kWall,
                   host.now);
  CHECK(host.starts == 0);
}

TEST_CASE("deputy: a command that the order does not list is stopped and forgotten") {
  Host host;
  host.order(1);
  host.deputy.hear({.utime = kWall, .deputy = "vehicle", .sheriff = "s", .commands = {}}, kWall, host.now);
  host.act();
  CHECK(host.signals == std::vector<int>{SIGINT});
  CHECK(host.deputy.info(kWall).commands.size() == 1);
  host.die(0);
  CHECK(host.deputy.info(kWall).commands.empty());
}

TEST_CASE("deputy: a changed command line counts from the next start") {
  Host host;
  host.order(1);
  host.deputy.hear(
      {.utime = kWall, .deputy = "vehicle", .sheriff = "s", .commands = {{{.id = "a", .exec = "other"}, 1, false}}},
      kWall, host.now);
  CHECK(host.deputy.take_acts().empty());
  CHECK(host.status().command.exec == "other");
}

TEST_CASE("deputy: a crash is told and respawned, later and later, and sooner again after a good while") {
  Host host;
  host.order(1, false, true);
  const std::vector<double> delays{0.010, 0.020, 0.040, 0.080, 0.160, 0.320, 0.640, 1.0, 0.5, 1.0};
  for (const double delay : delays) {  // as procman was measured, whose first one is 10 or 20 ms
    const int before = host.starts;
    host.die(kSegmentation);
    host.wait(delay - 0.001);
    CHECK(host.starts == before);
    host.wait(0.001 + kMicrosecond);
    CHECK(host.starts == before + 1);
  }
  CHECK(host.said.find("a: Segmentation fault\n") != std::string::npos);
  CHECK(host.status().run == 1);
  host.wait(30.0);
  host.die(kExit3);
  host.wait(0.6);
  CHECK(host.starts == 12);
  host.wait(30.0);
  const int before = host.starts;
  host.die(kExit3);
  CHECK(host.status().wait_status == kExit3);
  host.wait(0.011);
  CHECK(host.starts == before + 1);
}

TEST_CASE("deputy: what is not to be respawned stays down") {
  Host host;
  host.order(1);
  host.die(kExit3);
  host.wait(10.0);
  CHECK(host.starts == 1);
  CHECK(host.status().wait_status == kExit3);
  CHECK(host.said == "a: exit 3\n");
}

TEST_CASE("deputy: one that fell silent and does nothing is killed and started again") {
  Host host;
  host.order(1, false, true);
  host.deputy.healthy(host.status().pid, host.now);
  host.wait(3.9);
  CHECK(host.signals.empty());
  host.wait(0.2);
  CHECK(host.signals == std::vector<int>{SIGKILL});
  CHECK(host.said.find("says no HEALTH for 4 s and does nothing; killed") != std::string::npos);
  host.die(SIGKILL);
  host.wait(0.1);
  CHECK(host.starts == 2);
}

TEST_CASE("deputy: one that computes may be silent for a minute, one that never spoke for ever") {
  Host quiet;
  quiet.order(1, false, true);
  quiet.wait(300.0);
  CHECK(quiet.signals.empty());
  Host busy;
  busy.order(1, false, true);
  busy.deputy.healthy(busy.status().pid, busy.now);
  for (int i = 0; i < 59; ++i) {
    busy.deputy.uses("a", {.cpu = 0.5F, .computes = true}, busy.now);
    busy.wait(1.0);
  }
  CHECK(busy.signals.empty());
  for (int i = 0; i < 3; ++i) {
    busy.deputy.uses("a", {.cpu = 0.5F, .computes = true}, busy.now);
    busy.wait(1.0);
  }
  CHECK(busy.signals == std::vector<int>{SIGKILL});
}

TEST_CASE("deputy: one that hangs and is not to be respawned is only told, once") {
  Host host;
  host.order(1);
  host.deputy.healthy(host.status().pid, host.now);
  host.wait(5.0);
  host.wait(5.0);
  CHECK(host.signals.empty());
  CHECK(host.said.find("not restarted, since auto_respawn is off") != std::string::npos);
  CHECK(host.said.find("HEALTH") == host.said.rfind("HEALTH"));
}

TEST_CASE("deputy: HEALTH of another process number is not taken for this one's") {
  Host host;
  host.order(1, false, true);
  host.deputy.healthy(host.status().pid, host.now);
  for (int i = 0; i < 5; ++i) {
    host.wait(1.0);
    host.deputy.healthy(host.status().pid + 1, host.now);
  }
  CHECK(host.signals == std::vector<int>{SIGKILL});
}

TEST_CASE("deputy: shutting down stops all, hears no further order and is over when all are dead") {
  Host host;
  host.order(1, false, true);
  CHECK_FALSE(host.deputy.over());
  host.deputy.shut_down(host.now);
  host.act();
  CHECK(host.signals == std::vector<int>{SIGINT});
  host.order(7);
  CHECK(host.starts == 1);
  CHECK_FALSE(host.deputy.over());
  host.wait(7.1);
  CHECK(host.signals.back() == SIGKILL);
  host.die(SIGKILL);
  CHECK(host.deputy.over());
  CHECK(host.starts == 1);
}

TEST_CASE("deputy: a program that cannot be run counts as one that ended with 255") {
  Host host;
  host.deputy.hear(
      {.utime = kWall, .deputy = "vehicle", .sheriff = "s", .commands = {{{.id = "a", .exec = "no"}, 1, false}}}, kWall,
      host.now);
  CHECK(host.deputy.take_acts().size() == 1);
  host.die(65280);
  CHECK(host.status().pid == 0);
  CHECK(host.status().wait_status == 65280);
  CHECK(host.said == "a: exit 255\n");
}

TEST_CASE("deputy: orders from ahead of its clock are as stale as old ones") {
  constexpr double kThirtyYears = 30.0 * 365.25 * 86400.0;
  for (const double age : {-61.0, -kThirtyYears, 61.0}) {
    CAPTURE(age);
    Host host;
    host.order(1, false, false, "vehicle", age);
    CHECK(host.starts == 0);
    CHECK(host.said.find(age < 0.0 ? "ahead of this clock" : "61 s old") != std::string::npos);
  }
  Host host;
  host.order(1, false, false, "vehicle", -59.0);
  CHECK(host.starts == 1);
}

namespace {

AllowList allowed() {
  const test::Scratch scratch;
  test::write_bytes(scratch.path("allow.cfg"),
                    "cmd \"a\" { exec = \"prog\"; deputy = \"vehicle\"; }\n"
                    "cmd \"b\" { exec = \"other $X\"; deputy = \"vehicle\"; }\n"
                    "cmd \"c\" { exec = \"far\"; deputy = \"topside\"; }\n");
  return AllowList::load({scratch.path("allow.cfg")}, "vehicle");
}

}  // namespace

TEST_CASE("deputy: with an allow-list it runs the named command lines and no other, whatever is ordered") {
  const auto order = [](Host& host, const std::string& id, const std::string& exec, std::int32_t run) {
    host.deputy.hear({.utime = kWall,
                      .deputy = "vehicle",
                      .sheriff = "s",
                      .commands = {{{.id = id, .exec = exec, .group = "", .auto_respawn = true}, run, false}}},
                     kWall, host.now);
    host.act();
  };
  Host host;
  host.deputy = Deputy{"vehicle", allowed()};
  // A shell, another's line, a line with more behind it, the right line under another name, another deputy's.
  const std::pair<const char*, const char*> refused[] = {{"a", "bash -c id"}, {"a", "other $X"}, {"a", "prog -x"},
                                                         {"z", "prog"},       {"c", "far"},      {"a", ""}};
  std::int32_t run = 0;
  for (const auto& [id, exec] : refused) {
    CAPTURE(exec);
    host.said.clear();
    order(host, id, exec, ++run);
    CHECK(host.starts == 0);
    CHECK(host.said.find("refused: this command line is not in") != std::string::npos);
    CHECK(host.status().wait_status == 126 * 256);  // to its sheriff it has failed
    host.said.clear();
    order(host, id, exec, run);
    CHECK(host.said.empty());  // told once
    host.wait(5.0);
    CHECK(host.starts == 0);  // and not started again by itself
  }
  order(host, "a", "prog", ++run);
  CHECK(host.starts == 1);
}

TEST_CASE("deputy: a command line that is not allowed does not slip in behind one that is") {
  Host host;
  host.deputy = Deputy{"vehicle", allowed()};
  host.order(1, false, true);
  REQUIRE(host.starts == 1);
  const auto other = [&](std::int32_t run) {
    host.deputy.hear({.utime = kWall,
                      .deputy = "vehicle",
                      .sheriff = "s",
                      .commands = {{{.id = "a", .exec = "bash", .group = "", .auto_respawn = true}, run, false}}},
                     kWall, host.now);
    host.act();
  };
  other(1);  // the same run, while it runs
  CHECK(host.status().command.exec == "prog");
  host.die(kSegmentation);
  other(1);  // and while it waits to be started again
  host.wait(5.0);
  CHECK(host.starts == 2);
  CHECK(host.status().command.exec == "prog");
  other(2);  // anew: what ran is stopped, as by any order, and nothing is started
  host.die(0);
  other(2);
  host.wait(5.0);
  CHECK(host.starts == 2);
}

TEST_CASE("deputy: a list without a command for it is refused with what to look at") {
  const test::Scratch scratch;
  test::write_bytes(scratch.path("x.cfg"), "cmd \"c\" { exec = \"far\"; deputy = \"topside\"; }\n");
  const std::string said =
      test::complaint_of<InputError>([&] { (void)AllowList::load({scratch.path("x.cfg")}, "vehicle"); });
  CHECK_MESSAGE(said.find("no command for deputy 'vehicle'") != std::string::npos, said);
}

}  // namespace fathom::launch

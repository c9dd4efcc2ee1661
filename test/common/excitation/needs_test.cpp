// Processes that a trial needs: whoever falls silent, or never spoke, keeps the supervisor from arming and ends a trial
// that is under way; whoever comes back in time does not; and without a real clock nobody is called silent.
#include "common/excitation/needs.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <string>

#include "test/common/excitation/supervisor_loop.hpp"

namespace fathom::excitation {
namespace {

/// A bus in real time: everybody in `alive` says HEALTH each second, the clock is looked at ten times a second.
struct RealTime {
  Loop loop;
  std::set<std::string> alive{"estimator", "identifier", "thruster_driver"};
  double now{1000.0};
  bool looks{true};  // false: the supervisor itself stands still, or has no clock

  RealTime() {
    loop.settings.supervisor.needs = {"estimator", "identifier", "thruster_driver or simulator"};
    loop.settings.supervisor.silence = 5.0;
    loop.settings.supervisor.patience = 6.0;
    loop.supervisor = test::ready(loop.settings.supervisor, loop.settings.vehicle);
  }
  void run(double seconds) {
    for (int tenth = 0; tenth < static_cast<int>(std::lround(10.0 * seconds)); ++tenth) {
      if (tenth % 10 == 0) {
        for (const std::string& name : alive) loop.supervisor.hear(Health{.process = name, .state = "running"});
      }
      if (looks) loop.supervisor.watch(now);
      loop.run(0.1);
      now += 0.1;
    }
  }
  void start() {
    run(1.0);
    loop.arm();
    run(20.0);
    REQUIRE(loop.said->phase == "excite");
  }
};

}  // namespace

TEST_CASE("needs: a process that falls silent takes the thrust, then ends the trial, and is named with what to do") {
  for (const std::string victim : {"estimator", "identifier", "thruster_driver"}) {
    CAPTURE(victim);
    RealTime bus;
    bus.start();
    bus.alive.erase(victim);
    bus.run(3.5);
    CHECK(bus.loop.thrust());  // one that was killed is back by now
    bus.run(2.0);
    CHECK_FALSE(bus.loop.thrust());
    CHECK(bus.loop.said->phase == "lost");
    CHECK(bus.loop.said->reason.starts_with("no thrust: " + victim + " is silent: no HEALTH for "));
    bus.run(6.5);
    CHECK(bus.loop.supervisor.phase() == Phase::kAborted);
    CHECK(bus.loop.supervisor.reason() == victim +
                                              " is silent: no HEALTH for 11 s; start it, the sheriff's table "
                                              "tells why it does not run; then arm again");
    bus.loop.arm();
    bus.run(1.0);
    CHECK_FALSE(bus.loop.thrust());
    CHECK(bus.loop.supervisor.reason().starts_with("not armed: " + victim + " is silent"));
    bus.alive.insert(victim);
    bus.run(1.0);
    CHECK_FALSE(bus.loop.thrust());           // not without being armed
    bus.loop.plant.place({0.2, -0.1, 0.75});  // it has floated up
    bus.run(0.1);
    bus.loop.arm();
    bus.run(1.0);
    CHECK_MESSAGE(bus.loop.thrust(), bus.loop.supervisor.reason());
  }
}

TEST_CASE("needs: a process that is back in time does not end a trial") {
  RealTime bus;
  bus.start();
  for (const double away : {2.0, 4.0, 8.0}) {
    CAPTURE(away);
    bus.alive.erase("identifier");
    bus.run(away);
    bus.alive.insert("identifier");
    bus.run(4.0);
    CHECK(bus.loop.thrust());
    CHECK((bus.loop.said->phase == "excite" || bus.loop.said->phase == "approach"));
  }
}

TEST_CASE("needs: without those who never spoke it does not arm; a simulator stands in for the thruster driver") {
  RealTime nobody;
  nobody.alive = {"estimator", "identifier"};
  nobody.run(7.0);
  nobody.loop.arm();
  nobody.run(0.2);
  CHECK(nobody.loop.supervisor.reason().starts_with(
      "not armed: thruster_driver or simulator has not been heard for 7 s; start it"));
  CHECK_FALSE(nobody.loop.thrust());

  RealTime simulated;
  simulated.alive = {"estimator", "identifier", "simulator"};
  simulated.start();
  simulated.loop.supervisor.hear(Health{.process = "simulator", .state = "unhealthy", .detail = "comes late"});
  simulated.loop.run(1.0);
  CHECK(simulated.loop.thrust());
  simulated.alive.erase("simulator");
  simulated.run(13.0);
  CHECK(simulated.loop.supervisor.reason().starts_with("simulator is silent"));

  RealTime both;  // by bytes: the driver is there, and so it is the one that counts
  both.alive.insert("simulator");
  both.start();
  both.alive.erase("thruster_driver");
  both.run(13.0);
  CHECK(both.loop.supervisor.reason().starts_with("thruster_driver is silent"));
}

TEST_CASE("needs: a supervisor that stood still itself blames nobody") {
  RealTime bus;
  bus.start();
  bus.now += 60.0;
  bus.run(0.3);
  CHECK(bus.loop.thrust());
  bus.run(20.0);
  CHECK(bus.loop.supervisor.phase() == Phase::kExcite);
}

TEST_CASE("needs: in lockstep and from a log, where nobody looks at the clock, nobody is silent") {
  RealTime virtual_time;
  virtual_time.looks = false;
  virtual_time.start();
  virtual_time.alive.clear();
  virtual_time.run(40.0);
  CHECK(virtual_time.loop.supervisor.phase() == Phase::kExcite);
  CHECK(virtual_time.loop.thrust());
}

TEST_CASE("needs: when STATE ceases the trial is over after the patience, although nothing asks for a command") {
  for (const bool estimator : {true, false}) {
    CAPTURE(estimator);
    RealTime bus;
    bus.start();
    bus.loop.heard = false;
    if (!estimator) bus.alive.erase("estimator");
    bus.run(5.5);
    CHECK(bus.loop.supervisor.phase() == Phase::kExcite);
    bus.run(1.0);
    CHECK(bus.loop.supervisor.phase() == (estimator ? Phase::kLost : Phase::kAborted));
    CHECK(bus.loop.supervisor.reason().starts_with(estimator ? "no STATE came for 6 s" : "estimator is silent"));
    bus.loop.heard = true;  // an hour later somebody lifts the vehicle and finds the plug
    bus.run(2.0);
    CHECK_FALSE(bus.loop.thrust());
  }
}

TEST_CASE("needs: by STATE's own clock a gap above the patience ends a trial as well, a shorter one does not") {
  for (const double gap : {4.0, 7.0}) {
    CAPTURE(gap);
    Loop loop;
    loop.run(0.2);
    loop.arm();
    loop.run(20.0);
    loop.heard = false;
    loop.run(gap);
    loop.heard = true;
    loop.run(1.0);
    CHECK(loop.thrust() == (gap < loop.settings.supervisor.patience));
  }
}

}  // namespace fathom::excitation

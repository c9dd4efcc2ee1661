// Segments that are flown by their names: on order, as proposed, at the end without an order; and what stops a flight.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "common/base/spatial.hpp"
#include "test/common/excitation/supervisor_loop.hpp"

namespace fathom::excitation {
namespace {

/// An order to fly.
Operator flight(const Loop& loop, const std::string& segment, double duration = 0.0) {
  Operator o = order_to_arm(loop.plant.utime());
  o.order = "fly";
  o.segment = segment;
  o.duration = duration;
  return o;
}

EffectRanking proposal(const std::string& segment, double duration) {
  EffectRanking ranking{.verdict = "ambiguous", .candidates = {{.name = "current"}, {.name = "tether_tension"}}};
  ranking.against = "tether_tension";
  ranking.segment = segment;
  ranking.duration = duration;
  return ranking;
}

constexpr char kSurge[] = "full steps in surge";

}  // namespace

TEST_CASE("supervisor: a segment is flown from the middle of the room, as long as ordered, and the mode goes on") {
  Loop loop;
  loop.run(0.2);
  loop.arm();
  loop.run(25.0);
  REQUIRE(loop.said->phase == "excite");
  const std::string mode = loop.said->mode;
  loop.supervisor.hear(flight(loop, kSurge, 7.0));
  double begun = 0.0, flown = 0.0, least = 1e9;
  Vector6d most = Vector6d::Zero();
  for (int k = 0; k < 400 && (k == 0 || loop.said->mode == "segment"); ++k) {
    loop.run(0.1);
    least = std::min(least, loop.plant.room(loop.settings.site));
    if (!loop.said->active || loop.said->mode != "segment") continue;
    if (flown == 0.0) begun = (loop.plant.position() - loop.supervisor.fence().middle()).norm();
    flown += 0.1;
    CHECK(loop.said->signal == kSurge);
    CHECK(loop.said->duration == 7.0);
    most = most.cwiseMax(loop.said->probe.cwiseAbs());
  }
  CHECK(flown == doctest::Approx(7.0).epsilon(0.05));
  CHECK(begun < 0.3);  // near enough to the middle, or the time to get there was over
  CHECK(least > 0.02);
  CHECK(most[0] > 0.5 * loop.settings.supervisor.largest[0]);
  CHECK(most[5] == 0.0);  // held, not excited
  CHECK(loop.said->mode == mode);
  loop.run(20.0);
  CHECK(loop.said->phase == "excite");
}

TEST_CASE("supervisor: who is not armed arms for the flight alone, and the thrusters rest afterwards") {
  Loop loop;
  loop.run(0.2);
  loop.supervisor.hear(flight(loop, "full steps in surge", 3.0));
  CHECK(loop.supervisor.phase() == Phase::kApproach);
  loop.run(45.0);
  CHECK(loop.said->phase == "done");
  CHECK(loop.supervisor.reason() == "'full steps in surge' is flown");
  CHECK(loop.supervisor.visits().empty());
  loop.run(2.0);
  CHECK_FALSE(loop.thrust());
}

TEST_CASE("supervisor: a flight obeys abort, hold and skip, and a lost state") {
  for (const char* word : {"abort", "hold", "skip", "lost"}) {
    CAPTURE(word);
    Loop loop;
    loop.run(0.2);
    loop.supervisor.hear(flight(loop, kSurge));
    loop.run(18.0);
    REQUIRE(loop.said->active);
    if (std::string{word} == "abort") {
      loop.supervisor.hear(Operator{.abort = true});
      loop.run(0.5);
      CHECK(loop.said->phase == "aborted");
      CHECK_FALSE(loop.thrust());
    } else if (std::string{word} == "lost") {
      loop.valid = false;
      loop.run(0.5);
      CHECK_FALSE(loop.thrust());
      loop.valid = true;
      loop.run(0.1);
      CHECK(loop.said->phase == "approach");  // from where it begins, not from where it was cut
      CHECK(loop.said->mode == "segment");
    } else {
      loop.order(word);
      loop.run(0.1);
      CHECK(loop.said->phase == (std::string{word} == "hold" ? "hold" : "done"));
    }
  }
}

TEST_CASE("supervisor: what is proposed is flown when the operator allows it, never otherwise") {
  Loop loop;
  loop.run(0.2);
  loop.supervisor.hear(flight(loop, ""));
  CHECK(loop.supervisor.phase() == Phase::kDisarmed);
  CHECK(loop.supervisor.reason() == "not armed: nothing to fly: no segment is proposed");
  loop.run(0.1);
  loop.supervisor.hear(flight(loop, "a loop"));
  CHECK(loop.supervisor.reason() == "not armed: no segment 'a loop' for this vehicle; fathom plan names them");
  loop.supervisor.hear(proposal("full steps in sway", 4.0));
  loop.run(5.0);
  CHECK(loop.supervisor.phase() == Phase::kDisarmed);
  Operator weak = flight(loop, "");
  weak.enable = false;  // no permission to arm
  loop.supervisor.hear(weak);
  CHECK(loop.supervisor.phase() == Phase::kDisarmed);
  loop.run(0.1);
  loop.supervisor.hear(flight(loop, ""));
  for (int k = 0; k < 200 && (k == 0 || !loop.said->active); ++k) loop.run(0.1);
  CHECK(loop.said->signal == "full steps in sway");
  CHECK(loop.said->duration == 4.0);
  CHECK(loop.said->reason == "flies 'full steps in sway' to tell current from tether_tension");
}

TEST_CASE("supervisor: line, zigzag and circle are flown on a vehicle, in the open; a circle comes round once") {
  for (const std::string name : {"line", "zigzag", "circle"}) {
    CAPTURE(name);
    Loop loop;
    loop.settings.supervisor.open_range = 30.0;
    loop.settings.supervisor.fence.low = {-40.0, -40.0, -5.0};
    loop.settings.supervisor.fence.high = {40.0, 40.0, 20.0};
    loop.supervisor = test::ready(loop.settings.supervisor, loop.settings.vehicle);
    loop.plant.place(loop.settings.supervisor.fence.low * 0.5 + loop.settings.supervisor.fence.high * 0.5);
    loop.run(0.2);
    Operator order = flight(loop, name);
    CHECK(loop.supervisor.hear(order).done);
    for (int k = 0; k < 300 && !loop.said->active; ++k) loop.run(0.1);
    REQUIRE(loop.said->signal == name);
    const auto yaw = [&] { return euler_from_rotation(loop.plant.attitude().toRotationMatrix()).z(); };
    const Eigen::Vector3d begun = loop.plant.position();
    const double heading = yaw();
    double turned = 0.0, last = heading, most = 0.0, least = 0.0, flown = 0.0;
    for (; loop.said->active && flown < 60.0; flown += 0.1) {
      loop.run(0.1);
      turned += wrap_angle(yaw() - last);
      last = yaw();
      most = std::max(most, turned);
      least = std::min(least, turned);
    }
    const Eigen::Vector3d way = loop.plant.position() - begun;
    if (name == "line") {
      CHECK(flown == doctest::Approx(15.0).epsilon(0.05));
      CHECK(way.head<2>().norm() > 2.0);
      CHECK(std::abs(wrap_angle(std::atan2(way.y(), way.x()) - heading)) < 0.1);
      CHECK(most - least < 0.1);
    } else if (name == "zigzag") {  // to both sides, beyond the swing of .35 and not far
      CHECK(flown == doctest::Approx(40.0).epsilon(0.05));
      CHECK(most > 0.35);
      CHECK(most < 1.2);
      CHECK(least < -0.35);
      CHECK(least > -1.2);
    } else {
      CHECK(turned == doctest::Approx(-2.0 * std::numbers::pi).epsilon(0.05));  // to port
      CHECK(way.norm() < 2.0);
    }
    CHECK(std::abs(way.z()) < 0.3);  // the depth is held
    CHECK(loop.supervisor.reason() == "'" + name + "' is flown");
  }
}

TEST_CASE("supervisor: an armed one that cannot fly what is ordered says so and goes on") {
  Loop loop;
  loop.run(0.2);
  loop.arm();
  loop.run(25.0);
  loop.supervisor.hear(flight(loop, "a loop"));
  loop.run(0.1);
  CHECK(loop.said->phase == "excite");
  CHECK(loop.said->reason.ends_with("not flown: no segment 'a loop' for this vehicle; fathom plan names them"));
  loop.supervisor.hear(flight(loop, kSurge));
  loop.run(0.1);
  CHECK(loop.said->reason.find(kNotFlown) == std::string::npos);
}

TEST_CASE("supervisor: at the end it flies as many proposals as its settings allow") {
  for (const int allowed : {0, 1, 2}) {
    CAPTURE(allowed);
    Loop loop;
    loop.settings.supervisor.flights = allowed;
    loop.settings.supervisor.schedule.resize(1);
    loop.supervisor = test::ready(loop.settings.supervisor, loop.settings.vehicle);
    loop.run(0.2);
    loop.supervisor.hear(proposal(kSurge, 3.0));
    loop.arm();
    loop.run(1.0);
    loop.supervisor.hear(flight(loop, kSurge, 1.0));  // an order takes nothing from what is allowed without one
    loop.run(0.2);
    for (int k = 0; k < 300 && loop.said->mode == "segment"; ++k) loop.run(0.1);
    loop.order("skip");
    int flights = 0;
    bool before = false;
    for (int k = 0; k < 800 && loop.said->phase != "done"; ++k) {
      loop.run(0.1);
      const bool flying = loop.said->active && loop.said->mode == "segment";
      flights += flying && !before ? 1 : 0;
      before = flying;
    }
    CHECK(flights == allowed);
    CHECK(loop.supervisor.reason().starts_with("done, but not settled: "));  // a flight settles no mode
    CHECK(loop.said->phase == "done");
  }
}

}  // namespace fathom::excitation

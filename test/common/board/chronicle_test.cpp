// What has happened, once each; where it takes place; the whole of a trial in few points.
#include "common/board/chronicle.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/base/error.hpp"
#include "common/board/place.hpp"
#include "common/board/thinned.hpp"

namespace fathom::board {
namespace {

std::string file(const std::string& name) { return std::string{FATHOM_SOURCE_DIR} + "/config/" + name; }

std::string newest(const Chronicle& chronicle) {
  return chronicle.lines().empty() ? "" : chronicle.lines().back().kind + "|" + chronicle.lines().back().text;
}

}  // namespace

TEST_CASE("chronicle: a phase, a verdict, an order and a process are noted when they change, and only then") {
  Chronicle chronicle;
  Excitation said{.elapsed = 1.0, .mode = "yaw", .phase = "excite"};
  chronicle.hear(said, 1.0);
  CHECK(newest(chronicle) == "go|excite, mode yaw");
  said.elapsed = 2.0;
  chronicle.hear(said, 2.0);
  CHECK(chronicle.lines().size() == 1);
  chronicle.hear(Excitation{.reason = "the operator aborted", .phase = "aborted"}, 3.0);
  CHECK(newest(chronicle) == "bad|aborted: the operator aborted");
  EffectRanking ranking{.verdict = "effect", .candidates = {{.name = "current", .variant = "steady"}}};
  chronicle.hear(ranking, 4.0);
  chronicle.hear(ranking, 5.0);
  CHECK(newest(chronicle) == "|verdict: effect, first current steady");
  ModelEstimate model;
  chronicle.hear(model, 5.0);
  model.effects = {"current"};
  chronicle.hear(model, 6.0);
  CHECK(newest(chronicle) == "|the model adopts current");
  chronicle.hear(Answer{.process = "thruster_driver", .gate = true}, 7.0);  // twice a second, to no order
  CHECK(chronicle.lines().size() == 4);
  for (int i = 0; i < 2; ++i)
    chronicle.hear(Answer{.process = "supervisor", .sequence = 5, .text = "not armed: no recorder"}, 7.0 + i);
  CHECK(newest(chronicle) == "warn|order to supervisor: not armed: no recorder");
  CHECK(chronicle.lines().size() == 5);
  VehicleCondition vehicle{.lines = {{.name = "leak", .ok = true, .grave = true}}};
  chronicle.hear(vehicle, 9.0);
  vehicle.lines[0].ok = false;
  chronicle.hear(vehicle, 10.0);
  CHECK(newest(chronicle) == "bad|vehicle: NOT OK: leak");
  Roll::Entry one{.health = {.process = "estimator", .host = "here"}, .state = "running"};
  chronicle.look({&one, 1}, 11.0);
  CHECK(newest(chronicle) == "|estimator is there");
  one.state = "silent";
  one.detail = "no HEALTH for 4 s";
  chronicle.look({&one, 1}, 12.0);
  chronicle.look({&one, 1}, 13.0);
  CHECK(newest(chronicle) == "bad|estimator silent: no HEALTH for 4 s");
  one.state = "running";
  chronicle.look({&one, 1}, 14.0);
  CHECK(newest(chronicle) == "|estimator is back");
  for (int i = 0; i < 1000; ++i) chronicle.note(20.0, "", std::string(5000, 'x'));
  CHECK(chronicle.lines().size() == Chronicle::kMost);
  CHECK(chronicle.lines().back().text.size() <= 300);
}

TEST_CASE(
    "place: files of a vehicle, a site and a pipeline say where the trial is; told by a process they say the same") {
  Place place;
  std::string told;
  for (const char* name : {"vehicles/seabotix_lbv150.yaml", "sites/tank.yaml", "pipelines/tank.yaml"}) {
    place.take(Config::load(file(name)));
    CHECK(place.fence.has_value() == (std::string{name} == "pipelines/tank.yaml"));
  }
  CHECK(place.thrusters == std::vector<std::string>{"port", "starboard", "vertical", "lateral"});
  CHECK(place.site == "tank");
  REQUIRE(place.walls);
  CHECK(place.walls->low == Eigen::Vector2d(-2.5, -1.5));
  CHECK(place.walls->high == Eigen::Vector2d(2.5, 1.5));
  CHECK(place.floor == doctest::Approx(1.5));
  CHECK(place.tags.size() == 45);
  CHECK(place.tether_anchor == Eigen::Vector3d(-2.5, 0.0, -0.5));
  // Inside of the walls by at least the vehicle's half width.
  CHECK(place.fence->low.x() > -2.5 + 0.12);
  CHECK(place.fence->high.y() < 1.5 - 0.12);
  CHECK(place.fence->high.x() > 1.0);
  Place heard;
  CHECK_FALSE(heard.take_told("# file operator.yaml: not told, since it holds the operator's key\n"));
  CHECK_FALSE(heard.take_told("nothing of files"));
  CHECK(
      heard.take_told("# file site.yaml\nsite: elsewhere\nwater: {density: 1 kg/m^3}\nunknown: 3\n# file half.yaml\n"
                      "a: [b\n# file note.yaml\nnote: {a: b}\n"));
  CHECK(heard.site.empty());  // what cannot be read is left out
}

TEST_CASE("thinned: hours in a bounded number of points, evenly, with the first and the newest") {
  Thinned<int> kept{100, 1.0};
  bool bounded = true, newest_there = true;
  for (int i = 0; i < 36'000; ++i) {
    kept.add(0.1 * i, i);
    bounded = bounded && kept.points().size() <= 100;
    newest_there = newest_there && kept.points().back().value == i;
  }
  CHECK(bounded);
  CHECK(newest_there);
  CHECK(kept.points().front().value == 0);
  CHECK(kept.points().size() >= 40);
  double longest = 0.0;
  for (std::size_t i = 1; i < kept.points().size(); ++i)
    longest = std::max(longest, kept.points()[i].at - kept.points()[i - 1].at);
  CHECK(longest < 3600.0 / 25.0);
  kept.add(5.0, 7);  // time has fallen: another trial
  CHECK(kept.points().size() == 1);
}

TEST_CASE("chronicle: what was learned at the end, or why it was not") {
  Chronicle chronicle;
  chronicle.hear(LearnedTold{.adopted = true, .words = "A force."}, 1.0);
  CHECK(newest(chronicle) == "|learned: A force.");
  chronicle.hear(LearnedTold{.words = "log odds 12, at least 20 needed"}, 2.0);
  CHECK(newest(chronicle) == "|a force that no list holds is not learned: log odds 12, at least 20 needed");
}

}  // namespace fathom::board

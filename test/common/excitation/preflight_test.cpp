// The preflight list: what speaks against a trial is told line by line, what is well too.
#include "common/excitation/preflight.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "common/base/health_words.hpp"

namespace fathom::excitation {
namespace {

/// A vehicle ready to go.
PreflightInput ready() {
  PreflightInput heard;
  for (const char* name : {"estimator", "identifier", "thruster_driver", "recorder", "supervisor"}) {
    heard.health[name] = {Health{.process = name, .state = "running", .detail = "as it should be; dropped 3; "}, 0.5};
  }
  heard.state = {StateEstimate{.utime = 1, .valid = true}, 0.1};
  VehicleCondition vehicle{.utime = 1, .kind = "ArduSub"};
  vehicle.lines = {{"armed", true, false, "armed"}, {"mode", true, false, "MANUAL"}};
  heard.vehicle = {vehicle, 0.3};
  heard.place = Answer{.done = true, .text = "at 0.10 m north, 0.20 m east"};
  return heard;
}

/// Names of the lines that are not ok.
std::string against(const PreflightInput& heard, const std::vector<std::string>& needs = usual_needs()) {
  const auto lines = preflight(heard, needs);
  std::string names;
  for (const PreflightLine& line : lines) {
    if (!line.ok) names += line.name + " ";
  }
  CHECK(all_ok(lines) == names.empty());
  return names;
}

}  // namespace

TEST_CASE("preflight: all that must hold is listed, the recorder among it, and nothing speaks against it") {
  const auto lines = preflight(ready());
  CHECK(all_ok(lines));
  for (const char* name :
       {"estimator", "identifier", "thruster_driver", "recorder", "supervisor", "state", "place", "armed", "mode"}) {
    CAPTURE(name);
    CHECK(std::any_of(lines.begin(), lines.end(), [&](const PreflightLine& line) { return line.name == name; }));
  }
  CHECK(shown(lines.front()) == "ok      estimator       running: as it should be");
}

TEST_CASE("preflight: each trouble alone refuses, and its line names it") {
  auto heard = ready();
  heard.health.erase("recorder");
  CHECK(against(heard) == "recorder ");
  heard = ready();
  heard.health["recorder"].sample.state = "unhealthy";
  heard.health["recorder"].sample.detail = "the disk is nearly full: 3.0 MB free; make room";
  CHECK(against(heard) == "recorder ");
  heard = ready();  // what an arming mends does not stand in its way
  heard.health["thruster_driver"].sample.state = "unhealthy";
  heard.health["thruster_driver"].sample.detail = std::string{kNotArmedYet} + "; arm again; zero thrust: not armed";
  CHECK(against(heard).empty());
  heard = ready();
  heard.health["identifier"].age = 4.0;
  CHECK(against(heard) == "identifier ");
  heard = ready();
  heard.health["supervisor"].sample.state = "fault";
  CHECK(against(heard) == "supervisor ");
  heard = ready();
  heard.state->sample.valid = false;
  CHECK(against(heard) == "state ");
  heard = ready();
  heard.state.reset();
  CHECK(against(heard) == "state ");
  heard = ready();
  heard.place = Answer{.text = "too far north: at 2.45 m north"};
  CHECK(against(heard) == "place ");
  const auto lines = preflight(heard);
  const auto place = std::ranges::find(lines, kPlace, &PreflightLine::name);
  REQUIRE(place != lines.end());
  CHECK(
      place->text ==
      "too far north: at 2.45 m north; bring it inside the room, by hand or by its own ground station, then arm again");
  heard.place.reset();  // it was asked and did not answer
  CHECK(against(heard) == "place ");
  heard.health["supervisor"].age = 4.0;  // nobody is there to ask
  CHECK(against(heard) == "supervisor ");
  heard = ready();
  heard.vehicle->sample.lines[0] = {"armed", false, false, "the vehicle is disarmed: arm it"};
  CHECK(against(heard) == "armed ");
  heard = ready();
  heard.vehicle->age = 3.0;
  CHECK(against(heard) == "vehicle ");
  heard = ready();
  heard.vehicle.reset();
  CHECK(against(heard) == "vehicle ");
  CHECK(against(PreflightInput{}) == "estimator identifier thruster_driver recorder supervisor state ");
}

TEST_CASE(
    "preflight: a simulator stands in for thruster driver and recorder, and need not be well; a needs list of one's "
    "own counts") {
  auto heard = ready();
  heard.health.erase("thruster_driver");
  heard.health.erase("recorder");
  heard.vehicle.reset();
  heard.health["simulator"] = {Health{.process = "simulator", .state = "unhealthy", .detail = "late"}, 0.5};
  CHECK(against(heard).empty());
  heard.health["simulator"].sample.state = "stopped";
  CHECK(against(heard) == "simulator simulator ");
  heard = ready();
  heard.health.erase("identifier");
  CHECK(against(heard, {"estimator", "thruster_driver"}).empty());
}

}  // namespace fathom::excitation

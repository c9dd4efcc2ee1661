// The vehicle that is played: what is written as a condition, what is refused, and the rig's sentences by hand.
#include "common/devices/emulation/emulated_vehicle.hpp"

#include <doctest/doctest.h>

#include "common/base/error.hpp"
#include "common/devices/ardusub_modes.hpp"
#include "common/devices/dialogue.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/mavlink.hpp"
#include "common/devices/thruster_text.hpp"

using namespace fathom;
using namespace fathom::devices;

TEST_CASE("played vehicle: conditions by their words; anything else is refused and the known ones are named") {
  const PlayedCondition condition = PlayedCondition::parse("5.5:says=2,Leak Detected: tube 1");
  CHECK(condition.time == 5.5);
  EmulatedVehicle vehicle;
  play(vehicle, condition.word);
  REQUIRE(vehicle.words.size() == 1);
  CHECK(vehicle.words[0].severity == 2);
  CHECK(vehicle.words[0].text == "Leak Detected: tube 1");
  for (const char* word : {"disarmed", "mode=ALT_HOLD", "heartbeat=off", "failsafe=on", "obeys=off", "voltage=9.5"})
    play(vehicle, word);
  CHECK_FALSE(vehicle.armed);
  CHECK(vehicle.mode == "ALT_HOLD");
  CHECK_FALSE(vehicle.heartbeat);
  CHECK(vehicle.failsafe);
  CHECK_FALSE(vehicle.turns());
  CHECK(vehicle.voltage == 9.5);
  for (const char* text : {"disarmed", "x:disarmed", "-1:disarmed", "1:", "1:mode=FLY", "1:says=9,x", "1:says=2",
                           "1:voltage=much", "1:heartbeat=maybe"}) {
    CAPTURE(text);
    CHECK_THROWS_AS((void)PlayedCondition::parse(text), InputError);
  }
}

TEST_CASE("played vehicle: a motor test of a disarmed ArduSub is refused in its own words") {
  mavlink::Writer station{255, 190};
  EmulatedAnswers ardusub{"mavlink"};
  play(ardusub.vehicle(), "disarmed");
  (void)ardusub.hear(station.motor_test(3, 1620.0, 0.5, 1));
  CHECK(ardusub.applied()[3] == 1500.0);
  REQUIRE(ardusub.vehicle().words.size() == 1);
  CHECK(ardusub.vehicle().words[0].text == "Arm motors before testing motors.");
}

TEST_CASE("rig: its state and its words, and an older one's sentences as ever") {
  class Hears final : public Output {
   public:
    void frame(const Parser& parser, const Frame&) override {
      const auto& rig = dynamic_cast<const ThrusterText&>(parser);
      if (rig.state()) state = *rig.state();
      if (rig.words()) words = *rig.words();
      ++frames;
    }
    std::optional<RigState> state;
    std::optional<VehicleText> words;
    int frames{};
  } heard;
  Settings settings;
  settings.motors = 2;
  ThrusterText rig{settings};
  const auto feed = [&](const std::string& body) { rig.feed(as_bytes(detail::nmea_sentence(body)), heard); };
  feed("FTBAT,15.8");
  feed("FTAPP,1500,1600");
  CHECK_FALSE(heard.state);
  feed("FTSTA,1,RUN,0");
  REQUIRE(heard.state);
  CHECK(heard.state->armed);
  CHECK(heard.state->mode == "RUN");
  CHECK_FALSE(heard.state->failsafe);
  feed("FTSTA,0,,1");
  CHECK_FALSE(heard.state->armed);
  CHECK(heard.state->mode.empty());
  CHECK(heard.state->failsafe);
  heard.state.reset();
  for (const char* bad : {"FTSTA,2,RUN,0", "FTSTA,,RUN,0", "FTSTA,1,RUN,yes", "FTSTA"}) feed(bad);
  CHECK_FALSE(heard.state);
  feed("FTMSG,2,Leak, front tube");
  REQUIRE(heard.words);
  CHECK(heard.words->severity == 2);
  CHECK(heard.words->text == "Leak, front tube");
  heard.words.reset();
  feed("FTMSG,8,no such severity");
  CHECK_FALSE(heard.words);
}

TEST_CASE("ArduSub's modes: by name and by number") {
  CHECK(ardusub_mode("MANUAL") == 19U);
  CHECK(ardusub_mode_name(0) == "STABILIZE");
  CHECK(ardusub_mode_name(9) == "SURFACE");
  CHECK(ardusub_mode_name(77) == "mode 77");
  CHECK_FALSE(ardusub_mode("FLY"));
}

// Doppler logs: beams, instrument, ship and earth, worked by hand and brought back to the body.
#include "common/devices/janus.hpp"
#include "test/support/frames.hpp"

using namespace fathom;
using namespace fathom::test;
using devices::kRadians;

TEST_CASE("PD0: the bottom moves backward, so the recorded vehicle moves forward") {
  const auto rows = decode("pd0", wire_bytes("pd0_auv_dvl_short/adcp_auv_51.pd0"));
  const WireRow& row = rows[22];  // ensemble 36: 63, -1731, 26 mm/s starboard, forward, up; pitch 0.03, roll -7.76 deg
  REQUIRE(row.at("ens") == "36");
  const double roll = -7.76 * kRadians;
  CHECK(row.value("SI u [m/s]") == doctest::Approx(1.731).epsilon(0.001));
  CHECK(row.value("SI v [m/s]") == doctest::Approx(-0.063 * std::cos(roll) + 0.026 * std::sin(roll)).epsilon(0.02));
  CHECK(row.value("SI w [m/s]") == doctest::Approx(0.063 * std::sin(roll) + 0.026 * std::cos(roll)).epsilon(0.02));
  CHECK(row.value("SI altitude [m]") == doctest::Approx(14.0).epsilon(0.03));
}

TEST_CASE("PD0: an instrument whose profile toggles between up and down tracks one bottom") {
  // The forward speed of consecutive ensembles, which look up and down in turn, is one smooth curve.
  constexpr double kStep =
      1.0;  // m/s in two seconds: the vehicle gathers speed up to 1.7 m/s, and a wrong sign would show 3.4
  const auto rows = decode("pd0", wire_bytes("pd0_auv_dvl_short/adcp_auv_51.pd0"));
  for (std::size_t i = 1; i < rows.size(); ++i) {
    CHECK(rows[i].at("up") != rows[i - 1].at("up"));
    CHECK(rows[i].at("SI valid") == "1");
    CHECK(std::abs(rows[i].value("SI u [m/s]") - rows[i - 1].value("SI u [m/s]")) < kStep);
  }
}

TEST_CASE("beams: three numbers worked out by hand") {
  // Beams at 30 degrees: 1 to port, 2 to starboard, 3 ahead, 4 astern. A vehicle that moves ahead with 1 m/s comes
  // nearer to what beam 3 sees, with sin 30 = 0.5 m/s, and leaves what beam 4 sees.
  const auto ahead = devices::emulated_beam_velocities({1.0, 0.0, 0.0}, 30.0 * kRadians);
  CHECK(ahead[0] == doctest::Approx(0.0));
  CHECK(ahead[2] == doctest::Approx(0.5));
  CHECK(ahead[3] == doctest::Approx(-0.5));
  const devices::Janus janus{.beam_angle = 30.0 * kRadians};
  const auto bottom = devices::from_beams({0.0, 0.0, 0.5, -0.5}, janus);
  REQUIRE(bottom);
  CHECK(bottom->y() == doctest::Approx(-1.0));  // the bottom moves aft
  const auto three = devices::from_beams({std::nullopt, 0.0, 0.5, -0.5}, janus);
  REQUIRE(three);
  CHECK(three->isApprox(*bottom));
  CHECK_FALSE(devices::from_beams({std::nullopt, std::nullopt, 0.5, -0.5}, janus));
  CHECK_FALSE(devices::from_beams({0.0, 0.0, 0.5, -0.5}, {.beam_angle = 0.0}));
}

TEST_CASE("PD0: beam, instrument, ship and earth frames give the same velocity and altitude of the body") {
  const devices::Instant now = tilted();
  for (const auto frame : {devices::DvlFrame::kBeam, devices::DvlFrame::kInstrument, devices::DvlFrame::kShip,
                           devices::DvlFrame::kEarth}) {
    for (const double angle : {15.0, 20.0, 30.0}) {
      CAPTURE(name(frame));
      CAPTURE(angle);
      const auto rows = decode("pd0", devices::emulate("pd0", now, {}, {.frame = frame, .beam_angle_deg = angle}));
      REQUIRE(rows.size() == 1);
      CHECK((velocity(rows[0]) - now.dvl.v_WB_B).norm() < 3.0 * kMillimetre);
      CHECK(std::abs(rows[0].value("SI altitude [m]") - now.dvl.altitude) < kCentimetre);
      CHECK(rows[0].value("device_time") == doctest::Approx(now.time).epsilon(1e-12));
    }
  }
}

TEST_CASE("PD0: one beam without echo still gives a velocity, no echo at all gives none") {
  devices::Instant now = tilted();
  for (int bad = 0; bad < 4; ++bad) {
    const auto rows =
        decode("pd0", devices::emulate("pd0", now, {}, {.frame = devices::DvlFrame::kBeam, .bad_beam = bad}));
    REQUIRE(rows.size() == 1);
    CHECK((velocity(rows[0]) - now.dvl.v_WB_B).norm() < 6.0 * kMillimetre);
  }
  now.dvl.valid = false;
  for (const char* protocol : {"pd0", "pd4", "pd6", "wl_serial", "wl_json"}) {
    CAPTURE(protocol);
    bool told = false;
    for (const WireRow& row : decode(protocol, devices::emulate(protocol, now, {}))) {
      if (!row.has_sample) continue;
      told = true;
      CHECK(row.at("SI valid") == "0");
      CHECK(row.at("SI u [m/s]").empty());
    }
    CHECK(told);
  }
}

TEST_CASE("PD4 and PD5, PD6, Water Linked: the body's velocity comes back") {
  const devices::Instant now = tilted();
  for (const char* protocol : {"pd4", "pd6", "wl_serial", "wl_json"}) {
    CAPTURE(protocol);
    const auto rows = decode(protocol, devices::emulate(protocol, now, {}, {.frame = devices::DvlFrame::kShip}));
    REQUIRE_FALSE(rows.empty());
    const WireRow& last = rows.back();
    CHECK((velocity(last) - now.dvl.v_WB_B).norm() < 2.0 * kMillimetre);
    CHECK(std::abs(last.value("SI altitude [m]") - now.dvl.altitude) < kCentimetre);
  }
  const auto earth = decode("pd4", devices::emulate("pd4", now, {}, {.frame = devices::DvlFrame::kEarth}));
  REQUIRE(earth.size() == 1);
  CHECK((velocity(earth[0]) - now.dvl.v_WB_B).norm() < 2.0 * kMillimetre);
}

TEST_CASE("PD6: Water Linked's axes and Teledyne's, from their own examples") {
  const std::string bytes = wire_bytes("pd6_published_examples/examples.pd6");
  devices::Settings water_linked;
  water_linked.water_linked_axes = true;
  const auto theirs = decode("pd6", bytes, water_linked);
  REQUIRE(theirs[9].has_sample);  // :BI +123 -420 +2000: forward, starboard, down
  CHECK(velocity(theirs[9]).isApprox(Eigen::Vector3d{0.123, -0.420, 2.0}, kSingle));
  const auto teledyne = decode("pd6", bytes);
  REQUIRE(teledyne[20].has_sample);  // :BS -13 +21 -20: starboard, forward, up
  CHECK(velocity(teledyne[20]).isApprox(Eigen::Vector3d{0.021, -0.013, 0.020}, kSingle));
  CHECK(teledyne[20].value("SI altitude [m]") == doctest::Approx(7.13));
  CHECK(teledyne[26].at("SI valid") == "0");
  CHECK(teledyne[26].at("SI altitude [m]").empty());
}

TEST_CASE("PD6: an ensemble whose last line is damaged is told at the next one") {
  const devices::Instant now = tilted();
  std::string damaged = devices::emulate("pd6", now, {});
  damaged[damaged.find(":BD") + 5] = 'x';
  const auto rows = decode("pd6", damaged + devices::emulate("pd6", now, {}));
  std::vector<std::string> tags;
  for (const WireRow& row : rows) {
    if (row.has_sample) tags.push_back(row.at("tag"));
  }
  CHECK(tags == std::vector<std::string>{"SA", "BD"});
}

TEST_CASE("Water Linked: an invalid report is no velocity, whatever its numbers say") {
  const std::string report =
      R"({"vx":0.3,"vy":-0.1,"vz":0.2,"fom":0.01,"altitude":-1,"velocity_valid":false,"format":"json_v3","type":"velocity"})"
      "\r\n";
  const auto rows = decode("wl_json", report);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].at("SI valid") == "0");
  CHECK(rows[0].at("SI altitude [m]").empty());
  CHECK(decode("wl_json", R"({"time":12.5,"vx":1,"vy":2,"vz":3,"fom":0.1,"altitude":4,"velocity_valid":true})"
                          "\n")[0]
            .value("SI u [m/s]") == 1.0);  // json_v1 has no type
}

TEST_CASE("Water Linked: a report in a format of the future is no measurement, and is said") {
  std::string line = devices::emulate("wl_json", devices::emulated_motion(1.7e9, 0.0, {}), {});
  const std::size_t at = line.find("json_v3.1");
  REQUIRE(at != std::string::npos);
  class Counts final : public devices::Output {
   public:
    void frame(const devices::Parser&, const devices::Frame& frame) override {
      ++frames;
      if (frame.sample.index() != 0) ++samples;
    }
    int frames{}, samples{};
  } counts;
  const auto& protocol = devices::protocol("wl_json", "test");
  const auto parser = protocol.make({});
  parser->feed(devices::as_bytes(line), counts);
  CHECK(counts.samples == 1);
  CHECK(parser->complaint().empty());
  line.replace(at, 9, "json_v10.");
  parser->feed(devices::as_bytes(line), counts);
  CHECK(counts.samples == 1);
  CHECK(parser->complaint().find("speaks json_v10.") != std::string::npos);
}

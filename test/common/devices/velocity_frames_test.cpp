// Doppler logs: beams, instrument, ship and earth, worked by hand and brought back to the body.
#include "common/devices/velocity/janus.hpp"
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
  for (const char* protocol :
       {"pd0", "pd4", "pd6", "wl_serial", "wl_json", "nortek_text", "nortek_ad2cp", "cerulean"}) {
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

TEST_CASE("PD4 and PD5, PD6, Water Linked, Nortek, Cerulean: the body's velocity comes back") {
  const devices::Instant now = tilted();
  for (const char* protocol : {"pd4", "pd6", "wl_serial", "wl_json", "nortek_text", "nortek_ad2cp", "cerulean"}) {
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

TEST_CASE("Nortek text: the maker's examples, with their checksums") {
  const auto rows =
      decode("nortek_text",
             "$PNORBT7,1452244916.7508,1.234,-1.234,0.1234,0.1234,0.1234,12.34,23.45,23.45,23.45,23.45*39\r\n"
             "$PNORBT9,1452244916.7508,1.234,-1.234,0.1234,0.1234,0.1234,12.34,23.45,23.45,23.45,23.45,23.4,"
             "1567.8,1.2,12.3,0x000FFFFF*1E\r\n"
             "$PNORBT0,1,040721,131335.3341,23.961,-48.122,-32.76800,10.00000,0.00,0x00000000*48\r\n");
  REQUIRE(rows.size() == 3);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(rows[i].value("device_time") == doctest::Approx(1452244916.7508).epsilon(1e-13));
    CHECK(rows[i].value("vx_mps") == 0.1234);
    CHECK(rows[i].value("SI altitude [m]") == doctest::Approx(23.45));
    CHECK(rows[i].at("SI valid") == "0");  // 12.34 m/s of uncertainty is above what stands for "none"
  }
  CHECK_FALSE(rows[2].has_sample);  // one beam
}

TEST_CASE("Nortek text: forward, starboard, down of the vehicle; what is none; names before the values") {
  using devices::detail::nmea_sentence;
  const auto row = [](const std::string& body) { return decode("nortek_text", nmea_sentence(body)).at(0); };
  const WireRow plain = row("PNORBT7,1452244916.7508,-80.1,-95.2,1.250,-0.500,0.125,0.004,10.0,12.0,0.00,14.0");
  CHECK(velocity(plain) == Eigen::Vector3d{1.25, -0.5, 0.125});
  CHECK(plain.value("SI altitude [m]") == 12.0);  // of the three beams that found the bottom
  const WireRow named =
      row("PNORBT6,TIME=1452244916.7508,DT1=-80.1,DT2=-95.2,VX=1.250,VY=-0.500,VZ=0.125,FOM=0.004,D1=10.0,D2=12.0,"
          "D3=0.00,D4=14.0");
  CHECK(velocity(named) == velocity(plain));
  const std::string status =
      "PNORBT8,TIME=1.5,DT1=0,DT2=0,VX=1.250,VY=-0.500,VZ=0.125,FOM=0.004,D1=10.0,D2=12.0,D3=8.0,"
      "D4=14.0,BATT=15.9,SS=1500.0,PRESS=1.2,TEMP=8.0,STAT=0x";
  CHECK(velocity(row(status + "0000B0F0")) == velocity(plain));      // X, Y and the second of both vertical estimates
  CHECK(row(status + "0000D0F0").at("SI valid") == "0");             // Y is not valid: bit 13
  CHECK(row(status + "000030F0").at("SI valid") == "0");             // neither vertical estimate
  CHECK(row(status + "0000F030").value("SI altitude [m]") == 11.0);  // beams 1 and 2 alone
  CHECK(row("PNORBT7,1.5,0,0,-32.768,-0.5,0.1,0.004,10,12,0,14").at("SI valid") == "0");
  CHECK(row("PNORBT7,1.5,0,0,,-0.5,0.1,0.004,10,12,0,14").at("SI valid") == "0");
  CHECK_FALSE(row("PNORBT7,1.5,0,0,1.2,-0.5,0.1,0.004,10,12,0").has_sample);  // a value is missing
  CHECK_FALSE(row("PNORBT6,TIME=1,DT1=0,DT2=0,VY=1,VX=1,VZ=1,FOM=0,D1=1,D2=1,D3=1,D4=1").has_sample);  // another order
}

TEST_CASE("Nortek text: a format without three axes is named with what to choose") {
  const devices::Protocol& protocol = devices::protocol("nortek_text", "test");
  const auto parser = protocol.make({});
  const auto rows = decode_wire(*parser, protocol, {},
                                devices::detail::nmea_sentence("PNORBT4,1.234,-1.234,1.234,23.4,12.34567,12.3"));
  CHECK_FALSE(rows.at(0).has_sample);
  CHECK(parser->complaint().find("choose data format 356") != std::string::npos);
}

TEST_CASE("Nortek AD2CP: a bottom track made by hand from public descriptions") {
  const std::string record = unhex(
      "A5 0A 1B 10 D4 00 D6 2C F6 FD 01 24 A1 86 01 00 79 02 0E 07 08 09 C4 09 04 00 00 00 00 00 FF FF 0F 00 00 40 BA "
      "44 "
      "00 00 48 41 00 00 A0 3F 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 20 41 00 00 30 41 00 00 40 41 00 "
      "00 "
      "00 00 6F 12 03 3B 6F 12 03 3B 6F 12 03 3B 6F 12 03 3B 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
      "00 "
      "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 80 3F 00 00 80 BE 00 "
      "00 "
      "00 3F 00 00 80 3E 6F 12 03 3B 6F 12 03 3B 6F 12 03 3B 6F 12 03 3B 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
      "00 "
      "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 ");
  const auto rows = decode("nortek_ad2cp", record);
  REQUIRE(rows.size() == 1);
  CHECK(velocity(rows[0]) == Eigen::Vector3d{1.0, -0.25, 0.375});  // the mean of both vertical estimates
  CHECK(rows[0].value("SI altitude [m]") == 11.0);                 // of 10, 11 and 12; the fourth found none
  CHECK(rows[0].value("device_time") == doctest::Approx(1615705689.25).epsilon(1e-13));  // 14 March 2021, 07:08:09.25
  CHECK(rows[0].value("serial") == 100001);
  std::string damaged = record;
  damaged[150] ^= 1;
  CHECK(decode("nortek_ad2cp", damaged).empty());
  devices::Settings turned;  // its X points to starboard
  turned.R_BS = rotation_from_euler({0.0, 0.0, 90.0 * kRadians});
  CHECK(velocity(decode("nortek_ad2cp", record, turned).at(0)).isApprox(Eigen::Vector3d{0.25, 1.0, 0.375}, kSingle));
}

TEST_CASE("Cerulean: a displacement in an interval is the mean velocity at its middle") {
  using devices::detail::nmea_sentence;
  const auto row = [](const std::string& body) { return decode("cerulean", nmea_sentence(body)).at(0); };
  const WireRow maker = row("DVPDL,101234000,50000,0.001263,-0.019663,-0.745226,-0.000,0.001,-0.005,100");
  CHECK((velocity(maker) - Eigen::Vector3d{0.0, 0.02, -0.1}).norm() < kSingle);
  CHECK(maker.value("device_time") == doctest::Approx(101.234 - 0.025));
  CHECK(maker.at("SI altitude [m]").empty());
  const WireRow longer = row("DVPDX,101234000,100000,0,0,0,0.050,-0.010,0.002,80,1,0.5,-0.5,3.21");
  CHECK((velocity(longer) - Eigen::Vector3d{0.5, -0.1, 0.02}).norm() < kSingle);
  CHECK(longer.value("SI altitude [m]") == doctest::Approx(3.21));
  CHECK(row("DVPDL,101234000,50000,0,0,0,0.1,0.1,0.1,0").at("SI valid") == "0");      // no confidence
  CHECK(row("DVPDL,101234000,0,0,0,0,0.1,0.1,0.1,100").at("SI valid") == "0");        // no interval
  CHECK(row("DVPDL,101234000,5000000,0,0,0,0.1,0.1,0.1,100").at("SI valid") == "0");  // the mean of five seconds
  CHECK(row("DVPDL,101234000,50000,0,0,0,5.0,0.1,0.1,100").at("SI valid") == "0");    // 100 m/s
  CHECK_FALSE(row("DVPDL,101234000,50000,0,0,0,0.1,0.1,100").has_sample);             // a field was lost
}

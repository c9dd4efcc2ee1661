// Positions, ranges, loads and depths: signs, gaps and units, by hand.
#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "test/support/frames.hpp"

using namespace fathom;
using namespace fathom::test;
using devices::kRadians;

TEST_CASE("PSIMSSB: the maker's worked positions") {
  constexpr double kRounded = 0.05;  // m: the sentences round to a centimetre and a hundredth of a degree
  devices::Settings settings;
  settings.checksum_required = false;
  const auto rows = decode("nmea_usbl", wire_bytes("usbl_psimssb_examples/examples.nmea"), settings);
  CHECK((fix(rows[0]) - Eigen::Vector3d{50.0, 100.0, 48.5}).norm() < kRounded);
  CHECK((fix(rows[1]) - Eigen::Vector3d{50.0, -100.0, 25.8}).norm() < kRounded);
  CHECK((fix(rows[2]) - Eigen::Vector3d{-50.0, -100.0, 0.9}).norm() < kRounded);
  CHECK((fix(rows[3]).head<2>() - Eigen::Vector2d{-50.0, 100.0}).norm() < kRounded);
  CHECK_FALSE(rows[5].has_sample);                                                 // no reply: no position
  CHECK(rows[8].at("SI valid") == "0");                                            // a position that a filter refused
  CHECK(rows[11].value("SI sigma [m]") == 1.0);                                    // a negative accuracy is none
  CHECK(fix(rows[13]).isApprox(Eigen::Vector3d{-61.3, 39.017, 34.026}, kSingle));  // north, east
  CHECK(rows[13].value("SI sigma [m]") == doctest::Approx(0.072 / std::sqrt(2.0)));
}

TEST_CASE("PSIMSSB: a transceiver that looks east at a place of its own") {
  devices::Settings settings;
  settings.checksum_required = false;
  settings.transceiver = {.p_W = {10.0, 20.0, 1.0}, .heading = 90.0 * kRadians};
  const auto rows = decode("nmea_usbl", wire_bytes("usbl_psimssb_examples/examples.nmea"), settings);
  // Forward 50 is east, starboard 100 is south.
  CHECK((fix(rows[0]) - Eigen::Vector3d{10.0 - 100.0, 20.0 + 50.0, 49.5}).norm() < 0.05);
}

TEST_CASE("Sonardyne, iXblue and EvoLogics: positions in the world") {
  devices::Settings settings;
  settings.transceiver.latitude = 51.3306281 * kRadians;  // the ship of the first line
  settings.transceiver.longitude = -0.83499295 * kRadians;
  settings.transceiver.northing = 5688874.16;
  settings.transceiver.easting = 650879.0;
  const auto rows = decode("nmea_usbl", wire_bytes("usbl_other_families/examples.txt"), settings);
  CHECK(fix(rows[0]).norm() < 1e-6);
  // 0.0009125 degrees of latitude are 101.5 m there, 0.0006468 of longitude 45.1 m.
  CHECK((fix(rows[1]) - Eigen::Vector3d{101.5, -45.1, 999.916}).norm() < 0.1);
  CHECK((fix(rows[3]) - Eigen::Vector3d{43.4, -100.12, 1000.09}).norm() < 1e-6);
  CHECK_FALSE(rows[4].has_sample);  // the ship itself
  CHECK_FALSE(rows[6].has_sample);  // axes that are not described
  settings.transceiver.beacon = "2401";
  const auto chosen = decode("nmea_usbl", wire_bytes("usbl_other_families/examples.txt"), settings);
  CHECK_FALSE(chosen[0].has_sample);
  CHECK(chosen[1].has_sample);

  const auto modems = decode("evologics", wire_bytes("usbl_other_families/examples.txt"));
  REQUIRE(modems.size() == 4);
  CHECK(fix(modems[0]).isApprox(Eigen::Vector3d{-1.0020, -0.4233, 0.5901}, kSingle));
  // 825 us of sound at 1500 m/s
  CHECK(fix(modems[0]).norm() == doctest::Approx(825e-6 * 1500.0).epsilon(0.001));
  CHECK(modems[0].value("device_time") == doctest::Approx(10446.534643));
  CHECK_FALSE(modems[2].has_sample);
}

TEST_CASE("PTSAX, PTSAY: nothing without the stated axes, and each as its own are stated") {
  using devices::detail::nmea_sentence;
  const devices::Protocol& protocol = devices::protocol("nmea_usbl", "test");
  const auto configured = [&](const std::string& axes) {
    return devices::read_settings(
        Config::parse("beacon: ''\nsigma: 1 m\ntransceiver: {position: 10 20 1 m, heading: 90 deg" + axes + "}\n",
                      "test"),
        protocol);
  };
  const std::string line = nmea_sentence("PTSAX,#7,135006.00,07,02,2013,03,12.5,-4.0,F,0030.2,1,0000.0");
  const devices::Settings without = configured(", ptsay: north east");
  const auto silent = protocol.make(without);
  CHECK_FALSE(decode_wire(*silent, protocol, without, line).at(0).has_sample);
  CHECK(silent->complaint().starts_with("the system says X and Y ($PTSAX), whose directions are not public"));
  const std::vector<std::pair<std::string, Eigen::Vector3d>> cases{
      {"forward starboard", {10.0 + 4.0, 20.0 + 12.5, 31.2}},  // forward is east, starboard south
      {"forward port", {10.0 - 4.0, 20.0 + 12.5, 31.2}},
      {"starboard forward", {10.0 - 12.5, 20.0 - 4.0, 31.2}},
      {"north east", {10.0 + 12.5, 20.0 - 4.0, 31.2}},
      {"west south", {10.0 + 4.0, 20.0 - 12.5, 31.2}}};
  for (const auto& [axes, place] : cases) {
    CAPTURE(axes);
    const auto rows = decode("nmea_usbl", line, configured(", ptsax: " + axes));
    CHECK(fix(rows.at(0)).isApprox(place, kSingle));
    CHECK(rows[0].at("SI valid") == "1");
    CHECK(rows[0].value("device_time") == doctest::Approx(1360245006.0));
  }
  // A depth that is not valid is none, and the ship itself is no transponder.
  for (const char* other : {"PTSAY,#1,135006.00,07,02,2013,03,12.5,-4.0,F,0030.2,0,0000.0",
                            "PTSAY,#1,135006.00,07,02,2013,00,12.5,-4.0,F,0030.2,1,0000.0"}) {
    CHECK_FALSE(decode("nmea_usbl", nmea_sentence(other), configured(", ptsay: north east")).at(0).has_sample);
  }
  for (const std::string axes : {"forward", "forward east", "north south", "up port"})
    CHECK_THROWS_AS((void)configured(", ptsax: " + axes), InputError);
}

TEST_CASE("PTSAX, PTSAY: two sentences of one fix are one place, turned by the ship's heading") {
  devices::Settings settings;
  settings.transceiver.heading = 38.96 * kRadians;  // what lies between the two of a system at sea
  settings.transceiver.ptsax = devices::RelativeAxes{Eigen::Vector2d{1.0, -1.0}.asDiagonal(), false};
  settings.transceiver.ptsay = devices::RelativeAxes{Eigen::Vector2d{1.0, -1.0}.asDiagonal(), true};
  const auto rows = decode("nmea_usbl", wire_bytes("usbl_other_families/examples.txt"), settings);
  REQUIRE(rows[6].has_sample);
  REQUIRE(rows[7].has_sample);
  CHECK((fix(rows[6]) - fix(rows[7])).norm() < 0.2);
}

TEST_CASE("USBL: where only other transponders are heard that is said, beside the wanted one they are passed over") {
  devices::Settings settings;
  for (const std::string name : {"nmea_usbl", "evologics"}) {
    CAPTURE(name);
    const devices::Instant now = devices::emulated_motion(1.7e9, 1.0, {});
    settings.transceiver.beacon = "7";
    const std::string other = devices::emulate(name, now, settings);
    settings.transceiver.beacon = "8";
    const std::string ours = devices::emulate(name, now, settings);
    const devices::Protocol& protocol = devices::protocol(name, "test");
    const auto parser = protocol.make(settings);
    CHECK_FALSE(decode_wire(*parser, protocol, settings, other).at(0).has_sample);
    CHECK(parser->complaint() == "positions of transponder 7 come, none of 8; is 'beacon' right?");
    CHECK(decode_wire(*parser, protocol, settings, ours).at(0).has_sample);
    CHECK(parser->complaint().empty());
    CHECK_FALSE(decode_wire(*parser, protocol, settings, other).at(0).has_sample);
    CHECK(parser->complaint().empty());
  }
}

TEST_CASE("PSIMLBM: ranges in order, gaps as gaps, times as metres") {
  devices::Settings settings;
  settings.transponders = {"a", "b", "c", "d", "e"};
  settings.sound_speed = 1480.0;
  const auto sentence = [](const std::string& body) { return devices::detail::nmea_sentence(body); };
  auto rows =
      decode("psimlbm", sentence("PSIMLBM,120000.50,1,1,0.1,0.2,33.0,4.5,10.1,20.2,,40.4,50.5,60.6,,,M"), settings);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].value("SI range1 [m]") == 10.1);
  CHECK(rows[0].at("SI range3 [m]").empty());
  CHECK(rows[0].value("SI range5 [m]") == 50.5);
  CHECK_FALSE(rows[0].has("SI range6 [m]"));
  CHECK(rows[0].value("device_time") == 43200.5);
  rows = decode("psimlbm", sentence("PSIMLBM,,1,1,,,,,0.01,,,,,,,,S"), settings);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].value("SI range1 [m]") == doctest::Approx(14.8));
}

TEST_CASE("text ranges: names in any order, doubtful lines refused") {
  devices::Settings settings;
  settings.transponders = {"north", "east", "south", "west", "deep"};
  const auto rows = decode("range_text",
                           "deep=20.5, north=12.34 south= west=0\r\n"
                           "north=1 north=2\r\nup=3\r\nnorth=1.2.3\r\nnorth\r\neast=8.9\n",
                           settings);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].value("SI range1 [m]") == 12.34);
  CHECK(rows[0].at("SI range2 [m]").empty());
  CHECK(rows[0].at("SI range4 [m]").empty());  // a range of zero is none
  CHECK(rows[0].value("SI range5 [m]") == 20.5);
  CHECK(rows[1].value("SI range2 [m]") == 8.9);
}

TEST_CASE("loads: gain and zero per cell, named readings, and units that must fit") {
  devices::Settings settings;
  settings.cells = {{.name = "umbilical", .gain = 9.81, .zero = 0.5, .unit = "kg"}, {.name = "chain", .gain = -1.0}};
  auto rows = decode("load_text", "+00010.500 kg, 7.25\r12.0\r1 2 3\r1 lb 2\r", settings);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].value("SI load1 [N]") == doctest::Approx(98.1));
  CHECK(rows[0].value("SI load2 [N]") == doctest::Approx(-7.25));
  rows = decode("load_text", "umbilical=1.5 kg\nchain=2\nchain=3\numbilical=2.5\nsomething=1\n", settings);
  REQUIRE(rows.size() == 4);
  CHECK_FALSE(rows[0].has_sample);
  CHECK(rows[1].value("SI load1 [N]") == doctest::Approx(9.81));
  CHECK_FALSE(rows[2].has_sample);
  CHECK(rows[3].value("SI load2 [N]") == -3.0);
}

TEST_CASE("depth: an offset above zero is the transducer's depth, pressure becomes metres") {
  devices::Settings settings;
  settings.water_density = 1000.0;
  settings.gravity = 10.0;
  const auto sentence = [](const std::string& body) { return devices::detail::nmea_sentence(body); };
  const auto z = [&](const std::string& body) {
    return decode("nmea_depth", sentence(body), settings)[0].value("SI z [m]");
  };
  CHECK(z("KIDPT,4674.70,8.62,12000.0") == doctest::Approx(4683.32));
  CHECK(z("SDDPT,14.39,-2.00") == doctest::Approx(14.39));
  CHECK(z("SDDBT,,f,3.00,M,,F") == doctest::Approx(3.0));
  CHECK(z("SDDBT,10.0,f,,M,,F") == doctest::Approx(3.048));
  CHECK(z("PRVAT,00.210,M,0007.497,Metres") == doctest::Approx(7.497));
  CHECK(z("PRVAT,00.115,M,0010.000,dBar") == doctest::Approx(10.0));
  settings.pressure_is_absolute = true;
  CHECK(z("PRVAT,00.115,M,0020.1325,dBar") == doctest::Approx(10.0));
  CHECK(decode("nmea_depth", sentence("SDDPT,,0.0"), settings)[0].at("SI z [m]").empty());
}

TEST_CASE("SeaTrac: fixes made by hand from public descriptions") {
  const auto configured = [](const std::string& more) {
    return devices::read_settings(
        Config::parse("beacon: '3'\nsigma: 1 m\ntransceiver: {position: 10 20 1 m, heading: 0 deg" + more + "}\n",
                      "test"),
        devices::protocol("seatrac", "test"));
  };
  const std::string enhanced =
      "$420F030F07D204F1FF14000C002F3A85FF06010000A84201007B00049CFF9BFF9AFF99FFC20138FF0C005000ABFF2A000329\r\n";
  const auto rows = decode("seatrac", enhanced, configured(""));
  REQUIRE(rows.size() == 1);
  CHECK(fix(rows[0]).isApprox(Eigen::Vector3d{10.0 - 8.5, 20.0 + 8.0, 4.2}, kSingle));  // the depth is the beacon's own
  CHECK(rows[0].at("SI valid") == "1");
  CHECK(rows[0].at("beacon") == "3");
  CHECK(rows[0].value("distance_m") == 12.3);
  CHECK(rows[0].value("azimuth_deg") == 45.0);
  CHECK(rows[0].value("elevation_deg") == -20.0);
  CHECK(rows[0].value("head_yaw_deg") == 123.4);
  // Magnetic north 90 degrees to the east of true north: its east 8, north -8.5 are north -8, east -8.5.
  CHECK(fix(decode("seatrac", enhanced, configured(", declination: 90 deg")).at(0))
            .isApprox(Eigen::Vector3d{10.0 - 8.0, 20.0 - 8.5, 4.2}, kSingle));
  const std::string of_angles =  // a navigation answer: 4.2 m below the head at 1 m
      "$520F030707D204F1FF14000C002F3A85FF06010000A84201007B00049CFF9BFF9AFF99FFC20138FF0C005000ABFF2A00037AF6\r\n";
  CHECK(fix(decode("seatrac", of_angles, configured("")).at(0)).z() == doctest::Approx(5.2));
  const std::string doubted =
      "$420F031F07D204F1FF14000C002F3A85FF06010000A84201007B00049CFF9BFF9AFF99FFC20138FF0C005000ABFF2A001F20\r\n";
  CHECK(decode("seatrac", doubted, configured("")).at(0).at("SI valid") == "0");
  CHECK_FALSE(decode("seatrac", "$420F030107D204F1FF14000C002F3A85FF06010000A84201007B00326F\r\n").at(0).has_sample);
  CHECK_FALSE(decode("seatrac", "$100000000000000000000000003E90\r\n").at(0).has_sample);  // its own state
  devices::Settings other;
  other.transceiver.beacon = "2";
  CHECK_FALSE(decode("seatrac", enhanced, other).at(0).has_sample);
  std::string damaged = enhanced;
  damaged[40] = damaged[40] == '0' ? '1' : '0';
  CHECK(decode("seatrac", damaged).empty());
}

TEST_CASE("SeaTrac: the place comes back from an emulated one") {
  devices::Settings settings;
  settings.transceiver = {.p_W = {3.0, -2.0, 1.0}, .declination = 0.2};
  devices::Instant now = devices::emulated_motion(1.7e9, 4.0, settings);
  const auto rows = decode("seatrac", devices::emulate("seatrac", now, settings), settings);
  REQUIRE(rows.size() == 1);
  CHECK((fix(rows[0]) - now.usbl.p_WB).norm() < 0.1);  // it tells decimetres
}

TEST_CASE("EvoLogics: the line alone, as loggers keep it") {
  const std::string line =
      "USBLLONG,1446.52,1446.1,2,0.1,0.2,0.3,-0.4233,-1.0020,-0.5901,0.01,0.02,1.5,825,-40,120,0.05";
  const auto rows = decode("evologics", "noise " + line + "\r\n" + line + "\n");
  REQUIRE(rows.size() == 2);
  CHECK(fix(rows[0]).isApprox(Eigen::Vector3d{-1.0020, -0.4233, 0.5901}, kSingle));
  CHECK(rows[0].value("SI sigma [m]") == 0.05);
  CHECK(rows[0].value("device_time") == 1446.1);
  CHECK(decode("evologics", line.substr(0, line.rfind(',')) + "\r\n").empty());  // a word is missing
  std::string letter = line;
  letter[letter.find("0.4233") + 3] = 'x';
  CHECK(decode("evologics", letter + "\r\n").empty());
  // Inside of a frame whose stated length does not fit, it is no line of its own.
  CHECK(decode("evologics", "+++AT:90:" + line + "\r\n").empty());
}

TEST_CASE("frames without a sample say why") {
  class Reasons final : public devices::Output {
   public:
    void frame(const devices::Parser&, const devices::Frame& frame) override {
      last = frame.sample.index() == 0 ? std::string{frame.lacks} : "sample";
    }
    std::string last;
  };
  using devices::detail::nmea_sentence;
  const std::vector<std::array<std::string, 3>> cases{
      {"nmea_attitude", nmea_sentence("PSXN,23,0.1,0.2,,0.0"), "heading field empty and no $--HDT before"},
      {"nmea_attitude", nmea_sentence("GPZDA,120000,1,1,2020,,"), "a sentence that this protocol does not read"},
      {"nmea_depth", nmea_sentence("SDDPT,,0.0"), "depth field empty"},
      {"nmea_usbl", nmea_sentence("PSIMSSB,120000,B01,V,NRy,C,N,M,,,,,N,,"), "position fields empty"},
      {"nmea_depth", nmea_sentence("SDDPT,3.0,0.0"), "sample"},
      {"nortek_text", nmea_sentence("PNORBT4,1.2,-1.2,1.2,23.4,12.3,12.3"),
       "one beam, or speed and course alone: no velocity in three axes"}};
  for (const auto& [protocol, bytes, reason] : cases) {
    CAPTURE(bytes);
    Reasons reasons;
    const auto parser = devices::protocol(protocol, "test").make({});
    parser->feed(devices::as_bytes(bytes), reasons);
    CHECK(reasons.last == reason);
  }
}

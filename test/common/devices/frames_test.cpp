// Frames, signs and units by hand: what recordings cannot say, and what their tables do not.
#include <doctest/doctest.h>

#include <cmath>

#include "common/base/spatial.hpp"
#include "common/devices/attitude.hpp"
#include "common/devices/emulation.hpp"
#include "common/devices/janus.hpp"
#include "test/support/wire_data.hpp"

using namespace fathom;
using namespace fathom::test;
using devices::kRadians;

namespace {

constexpr double kMillimetre = 1.1e-3;  // m/s: what PD0, PD4 and PD6 round to, in each of two axes
constexpr double kHundredth = 2e-4;     // rad: a hundredth of a degree, twice
constexpr double kSingle = 1e-6;        // single precision of numbers about 10
constexpr double kCentimetre = 0.012;   // m

std::vector<WireRow> decode(const std::string& protocol, const std::string& bytes,
                            const devices::Settings& settings = {}) {
  const devices::Protocol& known = devices::protocol(protocol, "test");
  const auto parser = known.make(settings);
  return decode_wire(*parser, known, settings, bytes);
}

std::string unhex(const std::string& text) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 3) {
    bytes += static_cast<char>(std::stoi(text.substr(i, 2), nullptr, 16));
  }
  return bytes;
}

devices::Instant tilted() {
  devices::Instant now{.time = 1'700'000'000.25};
  now.ahrs.q_WB = Eigen::Quaterniond{rotation_from_euler({0.15, -0.1, 2.5})};
  now.ahrs.w_WB_B = {0.1, -0.2, 0.3};
  now.ahrs.f_B = {0.5, -0.25, -9.75};
  now.ahrs.has_rates = now.ahrs.has_specific_force = now.ahrs.has_attitude = true;
  now.dvl = Dvl{.v_WB_B = {1.2, -0.3, 0.2}, .altitude = 12.34};
  return now;
}

void check_vector(const WireRow& row, const std::array<const char*, 3>& names, const Eigen::Vector3d& wanted,
                  double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) {
    CAPTURE(names[i]);
    CHECK(std::abs(row.value(std::string{"SI "} + names[i]) - wanted(static_cast<Eigen::Index>(i))) < tolerance);
  }
}

Eigen::Vector3d velocity(const WireRow& row) {
  return {row.value("SI u [m/s]"), row.value("SI v [m/s]"), row.value("SI w [m/s]")};
}
Eigen::Quaterniond attitude(const WireRow& row) {
  return {row.value("SI qw"), row.value("SI qx"), row.value("SI qy"), row.value("SI qz")};
}
Eigen::Vector3d fix(const WireRow& row) {
  return {row.value("SI north [m]"), row.value("SI east [m]"), row.value("SI down [m]")};
}

}  // namespace

TEST_CASE("IG-500: a data frame made by hand from the maker's description") {
  const auto rows =
      decode("ig500", unhex("FF 02 90 00 2C 3D CC CC CD BE 4C CC CD 3F C0 00 00 3C 23 D7 0A 3C A3 D7 0A BC F5 "
                            "C2 8F 3F 00 00 00 BE 80 00 00 41 1C 00 00 00 01 E2 40 00 0F FF FF 25 C6 03 "));
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].value("device_time") == doctest::Approx(123.456));
  const Eigen::Quaterniond wanted{rotation_from_euler({0.1, -0.2, 1.5})};
  CHECK(attitude(rows[0]).angularDistance(wanted) < kSingle);
  check_vector(rows[0], {"p [rad/s]", "q [rad/s]", "r [rad/s]"}, {0.01, 0.02, -0.03}, kSingle);
  check_vector(rows[0], {"fx [m/s^2]", "fy [m/s^2]", "fz [m/s^2]"}, {0.5, -0.25, 9.75}, kSingle);
}

TEST_CASE("IG-500: frames of another mask than configured are refused and said") {
  devices::Settings settings;
  settings.output_mask = 0x1802;
  const devices::Protocol& known = devices::protocol("ig500", "test");
  const auto parser = known.make(settings);
  CHECK(decode_wire(*parser, known, settings, devices::emulate("ig500", tilted(), {})).empty());
  CHECK(parser->counters().bad_frame >= 1);
  CHECK(parser->complaint().find("output mask") != std::string::npos);
}

TEST_CASE("VN-100: the manual's example frame") {
  const auto rows = decode("vn100", unhex("FA 01 08 00 93 50 2E 42 83 3E F1 3F 48 B5 04 BB 92 88 "));
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].value("yaw_deg") == doctest::Approx(43.578686));
  CHECK(rows[0].value("roll_deg") == doctest::Approx(-0.0020249654));
  const Eigen::Quaterniond wanted{rotation_from_euler(Eigen::Vector3d{-0.0020249654, 1.8847202, 43.578686} * kRadians)};
  CHECK(attitude(rows[0]).angularDistance(wanted) < kSingle);
}

TEST_CASE("VN-100: attitude turns the recorded acceleration into the one it recorded in NED") {
  constexpr double kLogged = 0.02;  // m/s^2: both are of the same instant, the attitude is filtered
  for (const WireRow& row : decode("vn100", wire_bytes("vn100_short/F00294.bin"))) {
    const Eigen::Vector3d f_B{row.value("SI fx [m/s^2]"), row.value("SI fy [m/s^2]"), row.value("SI fz [m/s^2]")};
    const Eigen::Vector3d ned{row.value("accned0"), row.value("accned1"), row.value("accned2")};
    CHECK((attitude(row) * f_B - ned).norm() < kLogged);
  }
}

TEST_CASE("GX3: acceleration is specific force, up when at rest, in m/s^2") {
  for (const WireRow& row : decode("gx3", wire_bytes("gx3_short/20140313_191853.3dmgx3.log"))) {
    if (row.at("id") != "CB") continue;
    const Eigen::Vector3d f_B{row.value("SI fx [m/s^2]"), row.value("SI fy [m/s^2]"), row.value("SI fz [m/s^2]")};
    const Eigen::Vector3d field{row.value("v7"), row.value("v8"), row.value("v9")};
    CHECK(f_B.norm() == doctest::Approx(9.8).epsilon(0.02));
    CHECK(f_B.dot(field) < 0.0);  // north of the equator the field points down
  }
}

TEST_CASE("attitude sensors: rates, force and attitude come back from the bytes of an emulated one") {
  const devices::Instant now = tilted();
  for (const char* protocol : {"ig500", "sbg_ecom", "vn100", "gx3", "nmea_attitude"}) {
    CAPTURE(protocol);
    bool rates = false;
    bool turned = false;
    for (const WireRow& row : decode(protocol, devices::emulate(protocol, now, {}))) {
      if (!row.at("SI p [rad/s]").empty()) {
        rates = true;
        check_vector(row, {"p [rad/s]", "q [rad/s]", "r [rad/s]"}, now.ahrs.w_WB_B, kSingle);
        check_vector(row, {"fx [m/s^2]", "fy [m/s^2]", "fz [m/s^2]"}, now.ahrs.f_B, kSingle);
      }
      if (!row.at("SI qw").empty()) {
        turned = true;
        CHECK(attitude(row).angularDistance(now.ahrs.q_WB) < kHundredth);
      }
    }
    CHECK(turned);
    CHECK(rates == (std::string{protocol} != "nmea_attitude"));
  }
}

TEST_CASE("attitude sensors: a sensor turned by 90 degrees about down says the same of the body") {
  devices::Settings settings;
  settings.R_BS = rotation_from_euler({0.0, 0.0, 90.0 * kRadians});  // its x points to starboard
  devices::Instant body = tilted();
  devices::Instant sensor = body;  // what it feels in its own axes
  sensor.ahrs.w_WB_B = settings.R_BS.transpose() * body.ahrs.w_WB_B;
  sensor.ahrs.f_B = settings.R_BS.transpose() * body.ahrs.f_B;
  sensor.ahrs.q_WB = body.ahrs.q_WB * Eigen::Quaterniond{settings.R_BS};
  CHECK(sensor.ahrs.w_WB_B.x() == doctest::Approx(body.ahrs.w_WB_B.y()));
  for (const char* protocol : {"ig500", "vn100", "gx3"}) {
    CAPTURE(protocol);
    const auto rows = decode(protocol, devices::emulate(protocol, sensor, settings), settings);
    REQUIRE(rows.size() == 1);
    CHECK(attitude(rows[0]).angularDistance(body.ahrs.q_WB) < kHundredth);
    check_vector(rows[0], {"p [rad/s]", "q [rad/s]", "r [rad/s]"}, body.ahrs.w_WB_B, kSingle);
  }
}

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

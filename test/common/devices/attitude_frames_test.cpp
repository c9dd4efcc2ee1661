// Attitude sensors: frames, signs and units by hand: what recordings cannot say, and what their tables do not.
#include <algorithm>

#include "test/support/frames.hpp"

using namespace fathom;
using namespace fathom::test;
using devices::kRadians;

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

TEST_CASE("NMEA attitude: a sentence that lacks a field gives no attitude, one whose heave is empty does") {
  const auto row = [](const std::string& body) {
    return decode("nmea_attitude", devices::detail::nmea_sentence(body)).at(0);
  };
  CHECK(row("PSXN,23,0.10,-0.42,18.62,-0.03").has_sample);
  CHECK(row("PSXN,23,0.10,-0.42,18.62,").has_sample);
  CHECK_FALSE(row("PSXN,23,0.10,18.62,-0.03").has_sample);  // the checksum lets one such loss in 256 pass
  CHECK_FALSE(row("SBG01,120000.00,0.10,18.62,-0.03").has_sample);
}

TEST_CASE("attitude sensors: rates, force and attitude come back from the bytes of an emulated one") {
  const devices::Instant now = tilted();
  for (const char* protocol : {"ig500", "sbg_ecom", "vn100", "gx3", "xsens", "nmea_attitude"}) {
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
  for (const char* protocol : {"ig500", "vn100", "gx3", "xsens"}) {
    CAPTURE(protocol);
    const auto rows = decode(protocol, devices::emulate(protocol, sensor, settings), settings);
    REQUIRE(rows.size() == 1);
    CHECK(attitude(rows[0]).angularDistance(body.ahrs.q_WB) < kHundredth);
    check_vector(rows[0], {"p [rad/s]", "q [rad/s]", "r [rad/s]"}, body.ahrs.w_WB_B, kSingle);
  }
}

TEST_CASE("sbgECom: rates and attitude of one moment become one sample, and none is lost where they come apart") {
  class Keeps final : public devices::Output {
   public:
    void frame(const devices::Parser&, const devices::Frame& frame) override {
      if (const auto* ahrs = std::get_if<const Ahrs*>(&frame.sample)) samples.push_back(**ahrs);
    }
    std::vector<Ahrs> samples;
  };
  constexpr std::size_t kImuFrame = 58 + 9;
  const auto run = [&](int every) {  // an attitude to every so-manieth of the rates
    Keeps kept;
    const auto parser = devices::protocol("sbg_ecom", "test").make({});
    for (int k = 0; k < 40; ++k) {
      const std::string both = devices::emulate("sbg_ecom", devices::emulated_motion(10.0 + 0.01 * k, 0.0, {}), {});
      parser->feed(devices::as_bytes(k % every == 0 ? both : both.substr(0, kImuFrame)), kept);
    }
    return kept.samples;
  };
  const auto paired = run(1);
  CHECK(paired.size() == 42);  // the first two are told twice: nobody knew that an attitude would follow
  for (std::size_t k = 4; k < paired.size(); ++k) {
    CHECK(paired[k].has_attitude);
    CHECK(paired[k].has_rates);
    CHECK(paired[k].has_specific_force);
  }
  const auto apart = run(4);
  CHECK(std::count_if(apart.begin(), apart.end(), [](const Ahrs& s) { return s.has_rates && !s.has_attitude; }) == 40);
  CHECK(std::count_if(apart.begin(), apart.end(), [](const Ahrs& s) { return s.has_rates && s.has_attitude; }) == 10);
}

TEST_CASE("iXblue: pitch is positive with the bow down") {
  // Lines of a vehicle that rises with the bow up: 1.55 m/s through the water, 0.412 m/s upward, sin 15.7 deg = 0.27.
  const auto rows =
      decode("nmea_attitude",
             "$HEHDT,41.87,T*25\r\n$PIXSE,ATITUD,-0.729,-15.705*58\r\n$PIXSE,SPEED_,0.972,1.082,0.412*61\r\n");
  REQUIRE(rows.size() == 3);
  REQUIRE(rows[1].has_sample);
  CHECK(rows[1].value("pitch_deg") == -15.705);  // as told
  const Eigen::Quaterniond wanted{rotation_from_euler(Eigen::Vector3d{-0.729, 15.705, 41.87} * kRadians)};
  CHECK(attitude(rows[1]).angularDistance(wanted) < kSingle);
  CHECK((attitude(rows[1]) * Eigen::Vector3d{1.55, 0.0, 0.0}).z() == doctest::Approx(-0.412).epsilon(0.03));
  CHECK_FALSE(rows[2].has_sample);
}

TEST_CASE("iXblue: no attitude with the heading of an earlier block, none while it aligns") {
  using devices::detail::nmea_sentence;
  const std::string heading = nmea_sentence("HEHDT,41.87,T"), tilt = nmea_sentence("PIXSE,ATITUD,-0.729,-15.705");
  const auto samples = [](const std::string& bytes) {
    const auto rows = decode("nmea_attitude", bytes);
    return std::count_if(rows.begin(), rows.end(), [](const WireRow& row) { return row.has_sample; });
  };
  CHECK(samples(tilt + heading + tilt + tilt) == 1);  // before any heading; with it; its heading was used
  CHECK(samples(nmea_sentence("HETHS,41.87,A") + tilt) == 1);
  CHECK(samples(nmea_sentence("HETHS,41.87,V") + tilt) == 0);
  CHECK(samples(nmea_sentence("PIXSE,ALGSTS,00000042,00000000") + heading + tilt) == 0);
  CHECK(samples(nmea_sentence("PIXSE,ALGSTS,00000042,00000000") + heading + tilt +
                nmea_sentence("PIXSE,ALGSTS,00000045,00004000") + heading + tilt) == 1);
  CHECK(samples(heading + nmea_sentence("PIXSE,ATITUD,,-15.705")) == 0);
}

TEST_CASE("Xsens: two frames of devices, flat on a table, east-north-up") {
  const auto rows = decode(
      "xsens",
      unhex("FA FF 36 4E 10 60 04 02 53 35 CB 20 10 10 3F 7F FA 66 BB 40 34 B8 3C 49 96 2D 3B 5A 1F 82 80 20 0C 39 "
            "FF 91 01 BA EC DD 81 BA 86 53 80 40 20 0C BE 64 DB 99 BC E7 FF 83 41 1D C2 CF C0 20 0C BE 90 48 80 3F "
            "67 32 04 BF 54 89 04 E0 20 04 00 00 00 03 C9 "
            "FA FF 36 26 20 10 10 3E FC 23 42 3F 00 E0 28 BF 01 8F A7 3E FE EE B1 10 60 04 00 0A F8 4C E0 20 04 00 "
            "00 00 02 10 20 02 1B C5 D4 "));
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].value("device_time") == doctest::Approx(3900.7691));
  // The force that holds it up, in the body and turned to north, east, down.
  check_vector(rows[0], {"fx [m/s^2]", "fy [m/s^2]", "fz [m/s^2]"}, {-0.223494, 0.028320, -9.860061}, kSingle);
  const Eigen::Vector3d f_B{rows[0].value("SI fx [m/s^2]"), rows[0].value("SI fy [m/s^2]"),
                            rows[0].value("SI fz [m/s^2]")};
  CHECK((attitude(rows[0]) * f_B - Eigen::Vector3d{0.0, 0.0, -9.86}).norm() < 0.1);
  // It points east (yaw 2 (w z + x y) = 0.378 deg from there, anticlockwise): its heading is 89.622 deg.
  const Eigen::Vector3d ahead = attitude(rows[0]) * Eigen::Vector3d::UnitX();
  CHECK(std::atan2(ahead.y(), ahead.x()) / kRadians == doctest::Approx(89.6225).epsilon(1e-5));
  CHECK(rows[1].at("SI p [rad/s]").empty());
  CHECK_FALSE(rows[1].at("SI qw").empty());
}

TEST_CASE("Xsens: north-east-down, fixed point and double, by hand") {
  const auto rows =
      decode("xsens",
             unhex("FA FF 36 4A 10 60 04 00 BC 61 4E 20 35 0C 00 A0 00 00 01 40 00 00 01 E0 00 00 40 22 12 80 00 00 00 "
                   "00 00 C0 00 00 00 FF FF C0 00 00 00 00 09 80 23 18 3F B9 99 99 99 99 99 9A BF C9 99 99 99 99 99 9A "
                   "3F D3 33 33 33 33 33 33 E0 10 01 03 63 "));
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].value("device_time") == doctest::Approx(1234.5678));
  // Roll 10, pitch 20, yaw 30 degrees of a sensor whose z points up: half a turn of roll beside the body's.
  const Eigen::Quaterniond wanted{rotation_from_euler(Eigen::Vector3d{-170.0, 20.0, 30.0} * kRadians)};
  CHECK(attitude(rows[0]).angularDistance(wanted) < kSingle);
  check_vector(rows[0], {"p [rad/s]", "q [rad/s]", "r [rad/s]"}, {0.1, 0.2, -0.3}, kSingle);
  check_vector(rows[0], {"fx [m/s^2]", "fy [m/s^2]", "fz [m/s^2]"}, {0.5, 0.25, -9.75}, kSingle);
}

TEST_CASE("Xsens: an orientation that the sensor does not trust is none, and is said") {
  const devices::Protocol& protocol = devices::protocol("xsens", "test");
  const auto parser = protocol.make({});
  const auto untrusted =
      decode_wire(*parser, protocol, {},
                  unhex("FA FF 36 16 20 30 0C 00 00 00 00 00 00 00 00 00 00 00 00 E0 20 04 00 00 00 01 54 "));
  REQUIRE(untrusted.size() == 1);
  CHECK_FALSE(untrusted[0].has_sample);
  CHECK(parser->complaint().find("not yet valid") != std::string::npos);
  CHECK_FALSE(decode("xsens", unhex("FA FF 36 05 10 20 02 00 01 93 ")).at(0).has_sample);  // a counter alone
}

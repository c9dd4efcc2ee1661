// Attitude sensors: frames, signs and units by hand: what recordings cannot say, and what their tables do not.
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

#include <doctest/doctest.h>

#include <cmath>

#include "common/devices/checksum.hpp"
#include "common/devices/mavlink.hpp"
#include "common/devices/mavlink/definitions.hpp"
#include "test/support/foreign_logs.hpp"
#include "test/support/heard.hpp"

namespace fathom {
namespace {

using test::packed;

std::string stamp(std::uint64_t time) {
  std::string bytes;
  for (int shift = 56; shift >= 0; shift -= 8) bytes += static_cast<char>(time >> static_cast<unsigned>(shift) & 0xFFU);
  return bytes;
}

/// A MAVLink 2 frame of the vehicle.
std::string frame(std::uint32_t id, const std::string& payload, std::uint8_t component = 1) {
  std::string body = packed(static_cast<std::uint8_t>(payload.size()), std::uint8_t{0}, std::uint8_t{0},
                            std::uint8_t{7}, std::uint8_t{1}, component, static_cast<std::uint8_t>(id),
                            static_cast<std::uint8_t>(id >> 8U), static_cast<std::uint8_t>(id >> 16U)) +
                     payload;
  const auto* definition = devices::mavlink::definition(id);
  const char extra = static_cast<char>(definition == nullptr ? 0 : definition->crc_extra);
  const std::string checked = body + extra;
  return "\xFD" + body + packed(devices::crc16_reflected(devices::as_bytes(checked), 0xFFFF));
}

std::string attitude(std::uint32_t boot_ms, float roll) {
  return frame(30, packed(boot_ms, roll, 0.0F, 0.0F, 0.0F, 0.0F, 1.0F));
}

constexpr std::uint64_t kStart = 1'681'840'697'000'000;

}  // namespace

TEST_CASE("mavlink definitions: the extra byte of every message is what its names and types give") {
  CHECK(devices::mavlink::definitions().size() > 250);
  for (const auto& each : devices::mavlink::definitions()) {
    CAPTURE(each.name);
    CHECK(devices::mavlink::computed_extra(each) == each.crc_extra);
    CHECK(each.length <= 255);
  }
}

TEST_CASE("tlog: values with both times, zeros at the end of a payload, a list, an absent extension") {
  std::string log;
  for (unsigned i = 0; i < 5; ++i) log += stamp(kStart + 50'000U * i) + attitude(1000 + 50 * i, 0.1F);
  std::string pressure =
      packed(std::uint32_t{1300}, 1013.25F);  // the difference and the temperature are zero: not sent
  log += stamp(kStart + 300'000) + frame(137, pressure);
  const auto file = test::hear(log);
  CHECK(file.format == "tlog");
  const auto& topic = file.heard.of("ATTITUDE");
  REQUIRE(topic.stamps.size() == 5);
  CHECK(topic.stamps[2].log == static_cast<std::int64_t>(kStart) + 100'000);
  CHECK(topic.stamps[2].measured == 1'100'000);
  CHECK(topic.column("roll")[0] == static_cast<double>(0.1F));
  const auto& depth = file.heard.of("SCALED_PRESSURE2");
  CHECK(depth.column("press_abs")[0] == static_cast<double>(1013.25F));
  CHECK(depth.column("temperature")[0] == 0.0);
  CHECK(std::isnan(depth.column("temperature_press_diff")[0]));
  CHECK(file.damage.none());
}

TEST_CASE("tlog: a frame with a wrong checksum is named and costs none of its neighbours") {
  std::string bad = frame(132, packed(std::uint32_t{5}, std::uint16_t{1}, std::uint16_t{2}, std::uint16_t{3}), 194);
  bad.back() = static_cast<char>(bad.back() ^ 1);
  std::string log;
  for (unsigned i = 0; i < 4; ++i) {
    log += stamp(kStart + 2 * i) + attitude(i + 1, 1.0F);
    log += stamp(kStart + 2 * i + 1) + bad;
  }
  const std::string junk = "\xFD\x30\x01\xFE\x02";  // between two frames
  log += stamp(kStart + 50) + attitude(8, 1.0F);
  const auto file = test::hear(log + junk + stamp(kStart + 100) + attitude(9, 2.0F) + stamp(kStart + 101).substr(0, 5));
  CHECK(file.heard.of("ATTITUDE").stamps.size() == 6);
  CHECK_FALSE(file.heard.has("DISTANCE_SENSOR@1.194"));
  CHECK(file.damage.places("frames of DISTANCE_SENSOR with a wrong checksum") == 4);
  CHECK(file.damage.places("stretches of bytes that are no frame") == 1);
  CHECK(file.damage.places("frames cut off by the end of the file") == 1);
}

TEST_CASE("tlog: others than the vehicle, several batteries and named values are topics of their own") {
  std::string log = stamp(kStart) + frame(0, packed(std::uint32_t{0}, std::uint8_t{12}, std::uint8_t{3},
                                                    std::uint8_t{1}, std::uint8_t{4}, std::uint8_t{3}));
  log += stamp(kStart + 1) + frame(0,
                                   packed(std::uint32_t{0}, std::uint8_t{6}, std::uint8_t{8}, std::uint8_t{1},
                                          std::uint8_t{4}, std::uint8_t{3}),
                                   190);
  log += stamp(kStart + 2) + frame(251, packed(std::uint32_t{7}, 0.25F) + test::padded("Lights1", 10));
  const auto file = test::hear(log);
  CHECK(file.heard.has("HEARTBEAT"));
  CHECK(file.heard.has("HEARTBEAT@1.190"));
  CHECK(file.heard.of("NAMED_VALUE_FLOAT[Lights1]").column("value")[0] == 0.25);
}

TEST_CASE("tlog: a velocity log's shifts become a velocity") {
  std::string log;
  for (unsigned i = 0; i < 3; ++i)
    log += stamp(kStart + 100'000U * i) +
           frame(11011, packed(std::uint64_t{1'000'000} + 100'000U * i, std::uint64_t{100'000}, 0.0F, 0.0F, 0.0F, 0.05F,
                               -0.02F, 0.01F, 90.0F));
  const auto file = test::hear(log);
  const auto& topic = file.heard.of("VISION_POSITION_DELTA");
  CHECK(topic.column("velocity[0]")[0] == doctest::Approx(0.5).epsilon(1e-6));
  CHECK(topic.column("velocity[1]")[0] == doctest::Approx(-0.2).epsilon(1e-6));
}

TEST_CASE("decoding a tlog as mavlink: each frame has the time that stands before it, which is no damage") {
  struct Out final : devices::Output {
    void frame(const devices::Parser&, const devices::Frame& frame) override {
      times.push_back(frame.device_time.value_or(-1.0));
    }
    std::vector<double> times;
  } out;
  std::string log;
  for (unsigned i = 0; i < 5; ++i) log += stamp(kStart + 50'000U * i) + attitude(1000 + 50 * i, 0.1F);
  devices::Mavlink parser{devices::Settings{}};
  for (const char c : log) parser.feed(devices::as_bytes(std::string_view{&c, 1}), out);
  parser.finish(out);
  REQUIRE(out.times.size() == 5);
  for (unsigned i = 0; i < 5; ++i) CHECK(out.times[i] == doctest::Approx(1'681'840'697.0 + 0.05 * i).epsilon(1e-12));
  CHECK(parser.counters().skipped == 0);
}

}  // namespace fathom

#include <doctest/doctest.h>

#include "common/base/error.hpp"
#include "test/support/foreign_logs.hpp"
#include "test/support/heard.hpp"

namespace fathom {
namespace {

using test::packed;

test::UlogLog started() {
  test::UlogLog log{1000};
  log.format("gyro:uint64_t timestamp;uint64_t timestamp_sample;float[3] xyz;uint8_t flag;uint8_t[3] _padding0;");
  log.subscribe(0, 1, "gyro");
  return log;
}

std::string gyro(std::uint64_t time, float x) { return packed(time, time - 2000, x, 0.5F, -1.0F, std::uint8_t{3}); }

}  // namespace

TEST_CASE("ulog: nested formats, lists, padding in the middle and at the end, several instances") {
  test::UlogLog log = started();
  log.format("part:int16_t a;uint8_t[2] _padding0;float b;");
  log.format("whole:uint64_t timestamp;part[2] parts;char[4] name;bool on;");
  log.subscribe(0, 2, "whole");
  log.subscribe(1, 3, "gyro");
  log.data(1, gyro(1'000'000, 1.0F));
  log.data(2, packed(std::uint64_t{1'001'000}, std::int16_t{-5}, std::uint16_t{0}, 2.5F, std::int16_t{6},
                     std::uint16_t{0}, 3.5F) +
                  "abcd" + "\x01");
  log.data(3, gyro(1'002'000, 2.0F) + std::string(3, '\0'));  // padding stored after all
  const auto file = test::hear(log.bytes);
  CHECK(file.format == "ulog");
  CHECK(file.damage.none());
  const auto& first = file.heard.of("gyro");
  CHECK(first.stamps[0].log == 1'000'000);
  CHECK(first.stamps[0].measured == 998'000);
  CHECK(first.column("xyz[2]")[0] == -1.0);
  CHECK(file.heard.of("gyro[1]").column("xyz[0]")[0] == 2.0);
  const auto& whole = file.heard.of("whole");
  CHECK(whole.column("parts[0].a")[0] == -5.0);
  CHECK(whole.column("parts[1].b")[0] == 3.5);
  CHECK(whole.column("on")[0] == 1.0);
  CHECK(whole.words == "abcd");
}

TEST_CASE(
    "ulog: junk that claims a message, bytes that were lost, zeros to the end: the rest is kept and the loss counted") {
  test::UlogLog log = started();
  for (unsigned i = 0; i < 10; ++i) log.data(1, gyro(1'000'000 + 1000 * i, static_cast<float>(i)));
  const std::size_t at = log.bytes.size();
  for (unsigned i = 10; i < 20; ++i) log.data(1, gyro(1'000'000 + 1000 * i, static_cast<float>(i)));
  const std::string junk = std::string("\xFF\x7F\x44\x01\x00", 5) + "junk";
  std::string bytes = log.bytes.substr(0, at) + junk + log.bytes.substr(at);
  const auto file = test::hear(bytes + std::string(500, '\0'));
  const auto x = file.heard.of("gyro").column("xyz[0]");
  REQUIRE(x.size() == 20);
  for (std::size_t i = 0; i < x.size(); ++i) CHECK(x[i] == static_cast<double>(i));
  CHECK(file.damage.places("stretches of bytes that are no message") == 2);
  CHECK(file.damage.bytes() == junk.size() + 500);

  bytes.erase(at + junk.size() + 5, 11);  // within a message
  const auto shorter = test::hear(bytes);
  CHECK(shorter.heard.of("gyro").stamps.size() == 19);
}

TEST_CASE("ulog: cut inside a message; a time of zero is none; dropouts are told") {
  test::UlogLog log = started();
  log.data(1, packed(std::uint64_t{0}, std::uint64_t{0}, 1.0F, 1.0F, 1.0F, std::uint8_t{0}));
  log.message('O', packed(std::uint16_t{250}));
  log.data(1, gyro(1'000'000, 1.0F));
  const auto file = test::hear(log.bytes + std::string("\x20\x00\x44\x01\x00\x11", 6));
  const auto& topic = file.heard.of("gyro");
  REQUIRE(topic.stamps.size() == 2);
  CHECK(topic.stamps[0].log == recordings::kNoTime);
  CHECK(file.damage.places("messages cut off by the end of the file") == 1);
  CHECK(file.damage.places("dropouts that the logger itself reports, 250 ms together") == 1);
}

TEST_CASE("ulog: data appended after a crash begin where the flags say, whatever stood before them") {
  test::UlogLog log = started();
  log.data(1, gyro(1'000'000, 1.0F));
  log.bytes += std::string("\x25\x00\x44\x01\x00", 5);  // begun, and never ended
  const std::uint64_t appended = log.bytes.size();
  log.data(1, gyro(1'001'000, 2.0F));
  log.data(1, gyro(1'002'000, 3.0F));
  std::string flags = packed(std::uint64_t{0}, std::uint64_t{1}, appended, std::uint64_t{0}, std::uint64_t{0});
  log.bytes.replace(16 + 3, 40, flags);
  const auto file = test::hear(log.bytes);
  CHECK(file.heard.of("gyro").column("xyz[0]") == std::vector<double>{1.0, 2.0, 3.0});
  CHECK(file.damage.bytes() == 5);
}

TEST_CASE("ulog: a file that older readers must not read is refused") {
  test::UlogLog log = started();
  log.bytes[16 + 3 + 8] = 2;
  CHECK(test::complaint_of<InputError>([&] { (void)test::hear(log.bytes); }).find("must not read") !=
        std::string::npos);
}

}  // namespace fathom

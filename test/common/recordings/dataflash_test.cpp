#include <doctest/doctest.h>

#include <cmath>

#include "test/support/foreign_logs.hpp"
#include "test/support/heard.hpp"

namespace fathom {
namespace {

using test::packed;

std::string attitude(std::uint64_t time, float roll) { return packed(time, roll); }

/// Records every 20 ms; type 5.
test::DataFlashLog plain(int count, std::uint64_t start = 1'000'000) {
  test::DataFlashLog log;
  log.format(5, 15, "ATT", "Qf", "TimeUS,Roll");
  for (int i = 0; i < count; ++i)
    log.record(5, attitude(start + 20'000U * static_cast<unsigned>(i), static_cast<float>(i)));
  return log;
}

}  // namespace

TEST_CASE("dataflash: numbers are scaled by their letters and by nothing else") {
  test::DataFlashLog log;
  log.format(7, 3 + 8 + 2 + 2 + 4 + 4 + 4 + 4 + 2 + 1, "SCL", "QcCeELfgb", "TimeUS,a,b,c,d,e,f,g,h");
  log.record(7, packed(std::uint64_t{5}, std::int16_t{-123}, std::uint16_t{65535}, std::int32_t{-7}, std::uint32_t{9},
                       std::int32_t{473977420}, 1.5F, std::uint16_t{0xC100}, std::int8_t{-3}));
  const auto file = test::hear(log.bytes);
  CHECK(file.format == "dataflash");
  const auto& topic = file.heard.of("SCL");
  CHECK(topic.column("a")[0] == doctest::Approx(-1.23));
  CHECK(topic.column("b")[0] == doctest::Approx(655.35));
  CHECK(topic.column("c")[0] == doctest::Approx(-0.07));
  CHECK(topic.column("d")[0] == doctest::Approx(0.09));
  CHECK(topic.column("e")[0] == doctest::Approx(47.397742));
  CHECK(topic.column("f")[0] == 1.5);
  CHECK(topic.column("g")[0] == -2.5);  // half float: 1 10000 0100000000
  CHECK(topic.column("h")[0] == -3.0);
  CHECK(file.damage.none());
}

TEST_CASE("dataflash: junk between records costs no record, and a head of a record in it gives no false number") {
  const std::string good = plain(50).bytes;
  const std::size_t at = 2 * 89 + 20 * 15;  // behind the twentieth
  // What begins like a record of type 5, and then goes over into a true one.
  const std::string bytes = good.substr(0, at) + "\xA3\x95\x05\x11\x22\x33" + good.substr(at);
  const auto file = test::hear(bytes);
  const auto roll = file.heard.of("ATT").column("Roll");
  REQUIRE(roll.size() == 50);
  for (std::size_t i = 0; i < roll.size(); ++i) CHECK(roll[i] == static_cast<double>(i));
  CHECK(file.damage.bytes() == 6);
}

TEST_CASE("dataflash: a kind without FMT is named and counted, the others are read") {
  test::DataFlashLog log = plain(10);
  test::DataFlashLog whole;
  whole.bytes = log.bytes;
  for (int i = 0; i < 5; ++i) {
    whole.record(9, packed(std::uint64_t{1'200'000} + 20'000U * static_cast<unsigned>(i), 1.0F, 2.0F));
    whole.record(5, attitude(1'200'000U + 20'000U * static_cast<unsigned>(i), 99.0F));
  }
  const auto file = test::hear(whole.bytes);
  CHECK(file.heard.of("ATT").stamps.size() == 15);
  CHECK(file.damage.places("records of type 9, which no FMT describes") == 5);
}

TEST_CASE("dataflash: a file may begin anywhere, end in a record, hold a FMT late, twice, or of type 0") {
  test::DataFlashLog log = plain(10);
  log.format(5, 15, "ATT", "Qf", "TimeUS,Roll");  // said again
  log.format(0, 12, "ZERO", "QB", "TimeUS,Flag");
  log.record(0, packed(std::uint64_t{1'250'000}, std::uint8_t{1}));
  log.record(5, attitude(1'260'000, 7.0F));
  const auto file = test::hear("\x01\x02" + log.bytes.substr(0, log.bytes.size() - 3));
  CHECK(file.heard.of("ATT").stamps.size() == 10);
  CHECK(file.heard.of("ZERO").column("Flag")[0] == 1.0);
  CHECK(file.damage.places("records cut off by the end of the file") == 1);
}

TEST_CASE("dataflash: instances are topics of their own") {
  test::DataFlashLog log;
  log.format(6, 16, "BARO", "QBf", "TimeUS,I,Alt");
  for (unsigned i = 0; i < 6; ++i)
    log.record(
        6, packed(std::uint64_t{1'000'000} + 1000U * i, static_cast<std::uint8_t>(i % 2), i % 2 == 0 ? -9.0F : 0.5F));
  const auto file = test::hear(log.bytes);
  CHECK(file.heard.of("BARO[0]").column("Alt") == std::vector<double>{-9.0, -9.0, -9.0});
  CHECK(file.heard.of("BARO[1]").column("Alt") == std::vector<double>{0.5, 0.5, 0.5});
}

TEST_CASE("dataflash: descriptions that take turns, as in joined logs, are two topics and no more") {
  test::DataFlashLog log;
  for (unsigned i = 0; i < 4; ++i) {
    const bool second = i % 2 == 1;
    log.format(6, second ? 19 : 15, "BARO", second ? "Qff" : "Qf", second ? "TimeUS,Alt,Press" : "TimeUS,Alt");
    const std::string payload = packed(std::uint64_t{1'000'000} + 1000U * i, static_cast<float>(i));
    log.record(6, second ? payload + packed(9.0F) : payload);
  }
  const auto file = test::hear(log.bytes);
  CHECK(file.heard.of("BARO").column("Alt") == std::vector<double>{0.0, 2.0});
  CHECK(file.heard.of("BARO'").column("Alt") == std::vector<double>{1.0, 3.0});
}

TEST_CASE("dataflash: a description of units, or of an instance, that cannot be is not obeyed") {
  test::DataFlashLog log;
  log.format(20, 8, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds");  // 8 bytes where 44 are needed
  log.format(6, 19, "BARO", "QIf", "TimeUS,I,Alt");
  log.record(20, std::string(5, '\1'));
  log.record(6, packed(std::uint64_t{1'000'000}, std::uint32_t{4'000'000'000U}, 2.0F));
  log.record(20, std::string(5, '\1'));
  log.record(6, packed(std::uint64_t{1'000'100}, std::uint32_t{4'000'000'000U}, 3.0F));
  log.record(20, std::string(5, '\1'));  // behind which nothing stands, and whose time would lie beyond the file
  const auto file = test::hear(log.bytes);
  CHECK(file.heard.of("BARO").column("Alt") == std::vector<double>{2.0, 3.0});
  CHECK(file.damage.places("records of kind FMTU whose description does not fit its length") == 2);
}

TEST_CASE("dataflash: a velocity log's shifts become a velocity, unless their time is in a unit that cannot be") {
  test::DataFlashLog log;
  log.format(8, 3 + 8 + 32, "VISO", "Qffffffff", "TimeUS,dt,AngDX,AngDY,AngDZ,PosDX,PosDY,PosDZ,conf");
  log.record(8, packed(std::uint64_t{1'000'000}, 0.1F, 0.0F, 0.0F, 0.0F, 0.05F, -0.02F, 0.01F, 90.0F));
  log.record(8, packed(std::uint64_t{1'100'000}, 1e5F, 0.0F, 0.0F, 0.0F, 0.05F, -0.02F, 0.01F, 90.0F));
  const auto file = test::hear(log.bytes);
  CHECK(file.heard.of("VISO").column("VelX")[0] == doctest::Approx(0.5).epsilon(1e-6));
  CHECK(file.heard.of("VISO").column("VelY")[0] == doctest::Approx(-0.2).epsilon(1e-6));
  CHECK(std::isnan(file.heard.of("VISO").column("VelX")[1]));
}

TEST_CASE("dataflash: the text form says the same as the binary one") {
  const auto file = test::hear(
      "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 5, 15, ATT, Qf, TimeUS,Roll\n"
      "FMT, 6, 75, MSG, QZ, TimeUS,Message\nATT, 1000000, -0.5\nMSG, 1000001, a, b, and c\nATT, 1020000, NaN\nATT\n");
  CHECK(file.format == "dataflash_text");
  const auto& topic = file.heard.of("ATT");
  REQUIRE(topic.stamps.size() == 2);
  CHECK(topic.stamps[1].log == 1'020'000);
  CHECK(topic.column("Roll")[0] == -0.5);
  CHECK(std::isnan(topic.column("Roll")[1]));
  CHECK(file.heard.of("MSG").words == "a, b, and c");
  CHECK(file.damage.places("lines with too few fields") == 1);
}

}  // namespace fathom

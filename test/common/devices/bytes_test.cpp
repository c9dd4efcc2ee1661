// Check sums, numbers and words: the check values of their standards, and what must be refused.
#include <doctest/doctest.h>

#include "common/devices/checksum.hpp"
#include "common/devices/json.hpp"
#include "common/devices/text.hpp"

using namespace fathom::devices;

TEST_CASE("checksums: the standards' check values over the digits 1 to 9") {
  const Bytes digits = as_bytes("123456789");
  CHECK(crc16_reflected(digits, 0) == 0x2189);       // KERMIT
  CHECK(crc16_reflected(digits, 0xFFFF) == 0x6F91);  // MCRF4XX
  CHECK(crc16_xmodem(digits) == 0x31C3);
  CHECK(crc8(digits) == 0xF4);
  CHECK(sum16(digits) == 477);
  CHECK(xor8(digits) == 0x31);
}

TEST_CASE("bytes: both orders, whatever the machine") {
  const Bytes bytes = as_bytes("\x01\x02\x03\x84");
  CHECK(little<std::uint16_t>(bytes, 0) == 0x0201);
  CHECK(big<std::uint16_t>(bytes, 0) == 0x0102);
  CHECK(little24(bytes, 0) == 0x030201);
  CHECK(big<std::int32_t>(bytes, 0) == 0x01020384);
  CHECK(little<std::int32_t>(bytes, 0) == static_cast<std::int32_t>(0x84030201U));
}

TEST_CASE("numbers: digits, sign, point, and nothing else") {
  CHECK(number("12") == 12.0);
  CHECK(number("+00032.100") == 32.1);
  CHECK(number("-0.5") == -0.5);
  CHECK(number("51.3306281") == 51.3306281);
  CHECK(number("1325384364.662679") == 1325384364.662679);
  CHECK(number("0.12345678901234567890") == 0.12345678901234567890);
  CHECK(number("1e-07", true) == 1e-7);
  for (const char* bad : {"", " ", "1 ", " 1", "nan", "inf", "-", "+", ".", "1.", ".5", "1e5", "0x10", "1,5", "--1",
                          "+-1", "1.2.3", "12a"}) {
    CAPTURE(bad);
    CHECK_FALSE(number(bad));
  }
  CHECK_FALSE(number("1e", true));
  CHECK_FALSE(number("1e999", true));
  CHECK_FALSE(whole("-3"));
  CHECK_FALSE(whole("99999999999999999999"));
  CHECK(whole("0042") == 42);
}

TEST_CASE("times: seconds of the day and since 1970, and no time that there is not") {
  CHECK(time_of_day("180554.432").value() == doctest::Approx(65154.432));
  CHECK_FALSE(time_of_day(""));
  CHECK_FALSE(time_of_day("246000"));
  CHECK_FALSE(time_of_day("1805-4"));
  CHECK(seconds_since_1970(2014, 12, 19, 17, 17, 55.94).value() == doctest::Approx(1419009475.94));
  CHECK_FALSE(seconds_since_1970(2000, 0, 0, 0, 0, 0.0));
  CHECK_FALSE(seconds_since_1970(2023, 2, 29, 0, 0, 0.0));
  CHECK_FALSE(seconds_since_1970(2023, 257, 1, 0, 0, 0.0));
}

TEST_CASE("words: a missing field is an empty one, and too many are said") {
  const Words words{"a,,c", ','};
  CHECK(words.size() == 3);
  CHECK(words[1].empty());
  CHECK(words[7].empty());
  CHECK(Words{std::string_view{"1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,26,27,28,29,30,31,32,"
                               "33,34,35,36,37,38,39,40,41"},
              ','}
            .too_many());
}

TEST_CASE("JSON cursor: whole texts only, and no depth without end") {
  const auto fine = [](std::string_view text) {
    JsonCursor json{text};
    json.skip();
    return json.finished();
  };
  CHECK(fine(R"({"a":[1,-2.5e-3,true,false,null,"x\"y",{}],"b":[]})"));
  CHECK(fine(" { } "));
  for (const char* bad : {"", "{", "{]", "{\"a\"}", "{\"a\":}", "{\"a\":1,}", "[1 2]", "{\"a\":tru}", "{\"a\":+1}",
                          "{} x", "\"open", "[[[[[[[[[[[[[[]]]]]]]]]]]]]]"}) {
    CAPTURE(bad);
    CHECK_FALSE(fine(bad));
  }
}

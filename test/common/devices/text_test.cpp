// Words of lines that people and small firmwares write.
#include "common/devices/text.hpp"

#include <doctest/doctest.h>

using namespace fathom::devices;

TEST_CASE("next word: gaps of any length, before, between and behind") {
  std::string_view rest = "  -12.5 N,, 3;\t";
  CHECK(next_word(rest, " ,;\t") == "-12.5");
  CHECK(next_word(rest, " ,;\t") == "N");
  CHECK(next_word(rest, " ,;\t") == "3");
  CHECK(next_word(rest, " ,;\t").empty());
  CHECK(next_word(rest, " ,;\t").empty());
}

TEST_CASE("next word: what does not separate belongs to the word") {
  std::string_view rest = "a;b c";
  CHECK(next_word(rest, " ") == "a;b");
  CHECK(rest == " c");
}

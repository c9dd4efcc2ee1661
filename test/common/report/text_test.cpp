// Numbers and words read as intended.
#include "common/report/text.hpp"

#include <doctest/doctest.h>

#include <cmath>

using fathom::NamedValue;
using namespace fathom::report;

TEST_CASE("Numbers keep their significant digits and stay plain") {
  CHECK(number(0.012345) == "0.0123");
  CHECK(number(12345.0) == "12345");
  CHECK(number(-1.5) == "-1.50");
  CHECK(number(0.0) == "0");
  CHECK(number(std::nan("")) == "-");
  CHECK(number(2.5e-7) == "2.50e-07");
}

TEST_CASE("Odds are ratios, and powers of ten when huge") {
  CHECK(odds(std::log(20.0)) == "20 : 1");
  CHECK(odds(-std::log(8.0)) == "1 : 8.0");
  CHECK(odds(230.2585093) == "10^100 : 1");
}

TEST_CASE("An interval is half its width, or its ends where the sides differ") {
  NamedValue value{.name = "delay", .value = 2.0, .std = 0.5, .unit = "s"};
  CHECK(with_interval(value) == "2.00 ± 0.98 s");
  value.interval95 = {1.1, 2.9};
  CHECK(with_interval(value) == "2.00 ± 0.90 s");
  value.interval95 = {1.5, 4.0};
  CHECK(with_interval(value) == "2.00 (1.50 to 4.00) s");
}

TEST_CASE("Wrapping respects words, long words and characters of several bytes") {
  CHECK(wrap("one two three", 7) == std::vector<std::string>{"one two", "three"});
  CHECK(wrap("abcdefgh", 3) == std::vector<std::string>{"abc", "def", "gh"});
  CHECK(columns("±→R²") == 4);
  CHECK(pad_right("±→R²", 3) == "±→…");
  CHECK(pad_left("é", 3) == "  é");
}

TEST_CASE("Findings of several runs are grouped with their range") {
  const std::vector<fathom::ConsistencyFinding> findings{{"a", "gyro", "pose", "delay", 0.1, "s", "", "corrected"},
                                                         {"b", "gyro", "pose", "delay", 0.3, "s", "", "corrected"},
                                                         {"b", "dvl", "pose", "scale", 0.9, "", "", "reported only"}};
  const auto groups = group_findings(findings);
  REQUIRE(groups.size() == 2);
  CHECK(groups[0].members.size() == 2);
  CHECK(groups[0].members.front()->run == "b");
  CHECK(size_text(groups[0]) == "0.100 to 0.300 s");
  CHECK(size_text(groups[1]) == "0.900");
}

TEST_CASE("text: log odds that are even but for rounding are 0") {
  CHECK(log_odds_text(-7.6e-9) == number(0.0));
  CHECK(log_odds_text(-0.011) == number(-0.011));
  CHECK(log_odds_text(5.894) == "5.89");
}

TEST_CASE("text: errors say how far a motion can be foretold, where that is less than asked") {
  CHECK(how_far({40, 0, 0.0}).empty());
  CHECK(how_far({40, 30, 1.48})
            .starts_with(
                "In 30 of 40 predictions a small change of the start grows fivefold by the models, within 1.5 s"));
  CHECK(five_seconds_ahead({40, 0, 0.0}) == "5 s ahead");
  CHECK(five_seconds_ahead({40, 5, 2.0}) == "5 s ahead");
  CHECK(five_seconds_ahead({40, 30, 7.0}) == "5 s ahead");
  CHECK(five_seconds_ahead({40, 30, 1.48}) == "as far as it can be foretold, 1.5 s mostly");
}

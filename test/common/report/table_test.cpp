// The terminal's table fits its columns and says what matters.
#include "common/report/table.hpp"

#include <doctest/doctest.h>

#include <sstream>

#include "common/report/text.hpp"
#include "test/support/diagnosis_fixture.hpp"

using fathom::report::to_table;

namespace {

std::size_t widest(const std::string& table) {
  std::istringstream lines(table);
  std::size_t most = 0;
  for (std::string line; std::getline(lines, line);) most = std::max(most, fathom::report::columns(line));
  return most;
}

bool says(const std::string& table, const std::string& words) { return table.find(words) != std::string::npos; }

}  // namespace

TEST_CASE("The table never exceeds 100 columns") {
  auto result = fathom::test::made_up_report({.samples = 0}).result;
  CHECK(widest(to_table(result)) <= fathom::report::kTableColumns);

  result.vehicle = std::string(150, 'v');
  result.paragraph = std::string(300, 'x');
  result.candidates[0].variant = std::string(80, 'y');
  result.candidates[8].reason = std::string(200, 'z');
  result.consistency[0].evidence = std::string(200, 'e');
  result.consistency[0].signal = std::string(120, 's');
  result.effects[0].parameters[0].name = std::string(120, 'p');
  result.validate = {std::string(90, 'r'), "second"};
  for (auto& p : result.error_before.prediction) {
    p.rmse.fill(123456.789);
    p.r2.fill(-98765.4);
  }
  CHECK(widest(to_table(result)) <= fathom::report::kTableColumns);
}

TEST_CASE("The table names verdict, errors, effects with parameters and odds, refusals and sensors") {
  const std::string table = to_table(fathom::test::made_up_report({.samples = 0}).result);
  INFO(table);
  CHECK(says(table, "Verdict for Beluga <test>: effect"));
  CHECK(says(table, "surge u [m/s]"));
  CHECK(says(table, "yaw r [deg/s]"));
  CHECK_FALSE(says(table, "roll p"));
  CHECK(says(table, "10 s ahead"));
  CHECK(says(table, "time_constant = 0.352 ± 0.024 s"));
  CHECK(says(table, "215  92 %"));
  CHECK(says(table, "thruster gain (thruster 3)"));
  CHECK(says(table, "gyro.r against pose_capture: delay 0.0940 to 0.112 s (3 runs); corrected"));
}

TEST_CASE("An accepted effect is not listed among the refused") {
  const std::string table = to_table(fathom::test::made_up_report({.samples = 0}).result);
  const std::size_t refused = table.find("Effects refused");
  CHECK(table.find("thruster lag", refused) == std::string::npos);
  CHECK(table.find("tether tension", refused) != std::string::npos);
}

TEST_CASE("A result without anything still prints every heading") {
  const std::string table = to_table({});
  CHECK(says(table, "none was computed"));
  CHECK(says(table, "Effects accepted"));
  CHECK(says(table, "none found"));
}

// What counts as moved in a golden table.
#include "test/golden/table.hpp"

#include <doctest/doctest.h>

#include "test/support/scratch.hpp"

using namespace fathom::test;

namespace {

Table example() {
  return {.columns = {"t", "u", "verdict"},
          .rows = {{"0", "0", "adequate"}, {"1", "-2", "effect"}, {"2", "nan", "effect"}}};
}

}  // namespace

TEST_CASE("golden tables: the same is the same, not-a-number too, however it is written") {
  Table now = example();
  CHECK(moved(example(), now, 0.0, Of::kColumn).empty());
  now.rows[1][1] = "-2.0";
  CHECK(moved(example(), now, 0.0, Of::kColumn).empty());
}

TEST_CASE("golden tables: a number may move by the tolerance, as a share of its column or of itself") {
  Table now = example();
  now.rows[0][1] = "0.0019";  // of a column whose largest is 2
  CHECK(moved(example(), now, 1e-3, Of::kColumn).empty());
  CHECK(moved(example(), now, 1e-3, Of::kNumber).size() == 1);
  now.rows[0][1] = "0.0021";
  const auto lines = moved(example(), now, 1e-3, Of::kColumn);
  REQUIRE(lines.size() == 1);
  CHECK(lines[0] == "u: 1 of 3 moved, most at 0 from 0 to 0.0021, by 0.00105 of the column's largest");
  now.rows[0][1] = "0";
  now.rows[1][1] = "-2.1";
  CHECK(moved(example(), now, 0.049, Of::kNumber).size() == 1);
  CHECK(moved(example(), now, 0.051, Of::kNumber).empty());
}

TEST_CASE("golden tables: words, not-a-number, rows and columns that change are named") {
  Table now = example();
  now.rows[2][2] = "ambiguous";
  CHECK(moved(example(), now, 1.0, Of::kColumn) ==
        std::vector<std::string>{"verdict: 1 of 3 moved, most at 2 from effect to ambiguous"});
  now = example();
  now.rows[1][1] = "nan";
  CHECK(moved(example(), now, 1e9, Of::kColumn).size() == 1);
  now = example();
  now.rows.pop_back();
  now.rows.push_back({"3", "1", "effect"});
  CHECK(moved(example(), now, 1.0, Of::kColumn) == std::vector<std::string>{"1 rows are gone: 2", "1 rows are new: 3"});
  now = example();
  now.rows.push_back(now.rows[1]);
  CHECK(moved(example(), now, 1.0, Of::kColumn) == std::vector<std::string>{"the number of rows is another"});
  now = example();
  now.columns[1] = "v";
  CHECK(moved(example(), now, 1.0, Of::kColumn) == std::vector<std::string>{"the columns are others"});
}

TEST_CASE("golden tables: written and read again they are what they were") {
  const Scratch scratch;
  Table table = example();
  table.rows[0][2] = "one, two";  // a comma would end the cell
  write_table(scratch.path("a.csv"), table, "of a test");
  Table read = read_table(scratch.path("a.csv"));
  CHECK(read.columns == table.columns);
  REQUIRE(read.rows.size() == 3);
  CHECK(read.rows[0][2] == "one; two");
  CHECK(read.rows[1] == table.rows[1]);
  CHECK(cell(0.1) == "0.1");
  CHECK(cell(1.0 / 3.0) == "0.333333333");
  write_bytes(scratch.path("b.csv"), "a,b\n1\n");
  CHECK_THROWS_AS((void)read_table(scratch.path("b.csv")), std::runtime_error);
  CHECK_THROWS_AS((void)read_table(scratch.path("none.csv")), std::runtime_error);
}

#include "common/tables/csv.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "common/base/error.hpp"

using namespace fathom;
using namespace fathom::tables;

namespace {

std::string complaint(const std::string& text) {
  try {
    static_cast<void>(parse_csv(text, "run.csv"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

/// What is wrong with a column.
std::string fault(const CsvTable& table, const std::string& name) {
  return table.faults.at(static_cast<std::size_t>(table.find(name) - table.columns.data()));
}

}  // namespace

TEST_CASE("csv: a row of units below the header, as archives write it, is no row of numbers") {
  const CsvTable table = parse_csv("time,depth,pitch,status\nUTC,m,degrees,\n0,1,2,\n1,1,2,\n", "run.csv");
  CHECK(table.rows() == 2);
  CHECK(table.units == std::vector<std::string>{"", "m", "deg", ""});
  CHECK(table.where(0) == "run.csv:3");
  CHECK(table.faults == std::vector<std::string>(4));
  // Words that are no units are words of a row; a unit behind numbers is a fault there.
  CHECK(parse_csv("t,mode\nnone,idle\n1,run\n", "run.csv").rows() == 2);
  CHECK(parse_csv("t,depth\n0,1\ns,m\n1,2\n", "run.csv").faults[1].find("'m' is not a number") != std::string::npos);
}

TEST_CASE("csv: semicolons, with points or commas in the numbers, and tabs part columns as well") {
  const CsvTable semicolons = parse_csv("t;\"u\"; v\r\n0,5;-1.5e-3;\r\n1;-2,5E+1;nan\r\n", "run.csv");
  CHECK(semicolons.names == std::vector<std::string>{"t", "u", "v"});
  CHECK(*semicolons.find("t") == std::vector<double>{0.5, 1.0});
  CHECK(*semicolons.find("u") == std::vector<double>{-1.5e-3, -25.0});
  CHECK(std::isnan((*semicolons.find("v"))[1]));
  CHECK(fault(semicolons, "v").empty());
  CHECK(*parse_csv("t\tu\r\n0\t1.5\r\n", "run.csv").find("u") == std::vector<double>{1.5});
  CHECK(complaint("t\t\n0\n") == "no complaint");
  // Thousands that are parted by commas are no decimals.
  for (const char* text : {"t\tu\n0\t1,234\n", "t;u\n0;1,234.5\n", "t;u\n0;1,234,567\n"})
    CHECK(fault(parse_csv(text, "run.csv"), "u").ends_with("is not a number"));
}

TEST_CASE("csv: another separator is named, with the remedy") {
  CHECK(complaint("t|u\n0|1\n") == "run.csv:1: separator '|': save the table with commas between its columns");
  CHECK(complaint("t u\n0 1\n") == "run.csv:1: separator blank: save the table with commas between its columns");
}

TEST_CASE("csv: in quotes a separator is text, and so is a column of words, which refuses nothing by itself") {
  const CsvTable table = parse_csv("t,mode,\"u\"\n0,\"surge, slow\",\"1.5\"\n1,yaw,2\n", "run.csv");
  CHECK(*table.find("u") == std::vector<double>{1.5, 2.0});
  CHECK(fault(table, "mode") == "run.csv:2: column 'mode': 'surge, slow' is not a number");
  CHECK(std::isnan((*table.find("mode"))[1]));
}

TEST_CASE("csv: names, numbers, Windows line ends, comments, blank lines and a byte order mark are read") {
  const CsvTable table =
      parse_csv("\xEF\xBB\xBF# a comment\r\nt, \"u\" ,v\r\n0, 1.5,-2e-3\r\n\r\n0.1,+3,4\r\n", "run.csv");
  CHECK(table.names == std::vector<std::string>{"t", "u", "v"});
  REQUIRE(table.rows() == 2);
  CHECK(*table.find("u") == std::vector<double>{1.5, 3.0});
  CHECK(*table.find("v") == std::vector<double>{-2e-3, 4.0});
  CHECK(table.find("w") == nullptr);
  CHECK(table.where(1) == "run.csv:5");
}

TEST_CASE("csv: empty, nan, infinite cells and fill values are missing numbers, not errors") {
  const CsvTable table = parse_csv("t,u\n0,\n1,nan\n2,inf\n3,-Infinity\n4,-3.4028235e38\n5,1e308\n6,7", "run.csv");
  REQUIRE(table.rows() == 7);
  for (std::size_t row = 0; row < 6; ++row) CHECK(std::isnan((*table.find("u"))[row]));
  CHECK((*table.find("u"))[6] == 7.0);
}

TEST_CASE("csv: what is wrong is said in one line with the file's line") {
  const auto of_u = [](const char* text) { return fault(parse_csv(text, "run.csv"), "u"); };
  CHECK(of_u("t,u\n0,1\n1,x1\n2,x2\n") == "run.csv:3: column 'u': 'x1' is not a number");
  CHECK(of_u("t,u\n0,1\n1,1 2\n") == "run.csv:3: column 'u': '1 2' is not a number");
  CHECK(of_u("t,u\n0,1e999\n") == "run.csv:2: column 'u': '1e999' is not a number");
  CHECK(of_u("t,u\n0,1\n") == "");
  CHECK(of_u("t,u\n0,05/06/2024 10:00:00\n").find("'05/06/2024 10:00:00' leaves open which is the day") !=
        std::string::npos);
  CHECK(std::isnan(parse_csv("t,u\n0,1 2\n", "run.csv").find("u")->front()));
  CHECK(complaint("t,u\n0,1\n1\n2,3\n") == "run.csv:3: this row has 1 cells, the header names 2");
  CHECK(complaint("t,u\n0,1\n1,2,3\n4,5\n") == "run.csv:3: this row has 3 cells, the header names 2");
  CHECK(complaint("t,u\n0,1\n1") == "run.csv:3: this row has 1 cells, the header names 2 (was the file cut off?)");
  CHECK(complaint("t,u,t\n0,1,2\n") == "run.csv:1: column 't' stands here twice");
  CHECK(parse_csv(",t,u\n0,0.0,1\n1,0.1,2\n", "run.csv").names == std::vector<std::string>{"(row)", "t", "u"});
  CHECK(complaint("t,u\n0,1\nt,u\n0,2\n").starts_with("run.csv:3: the header stands here again"));
  CHECK(complaint("t,,u\n0,1,2\n") == "run.csv:1: column 2 has no name; give it one, or take its separator away");
  CHECK(complaint("") == "run.csv: the file is empty");
  CHECK(complaint("t,u\n") == "run.csv: there is a header but not one row of numbers");
  for (const char* path : {"/nowhere/run.csv", "/tmp"}) {
    CHECK_THROWS_WITH_AS(static_cast<void>(read_csv(path)), (std::string(path) + ": cannot read this file").c_str(),
                         InputError);
  }
}

TEST_CASE("csv: percent signs begin comments too, and the last one names the columns where no header does") {
  const CsvTable table = parse_csv("% made by a glider\n% t, u, v\n0, 1, 2\n# more\n1, 3, 4\n", "run.csv");
  CHECK(table.names == std::vector<std::string>{"t", "u", "v"});
  CHECK(*table.find("v") == std::vector<double>{2.0, 4.0});
  CHECK(parse_csv("# a, b\nt,u\n0,1\n", "run.csv").names == std::vector<std::string>{"t", "u"});
  CHECK(complaint("0,1\n2,3\n").find("the first line holds numbers where the names") != std::string::npos);
}

TEST_CASE("csv: a unit in brackets behind a name is no part of it") {
  const CsvTable table = parse_csv("t [ms],u (m/s),\"psi [degrees]\",f(1),x [m],x [ft]\n0,1,2,3,4,5\n", "run.csv");
  CHECK(table.names == std::vector<std::string>{"t", "u", "psi", "f(1)", "x [m]", "x [ft]"});
  CHECK(table.units == std::vector<std::string>{"ms", "m/s", "deg", "", "m", "ft"});
  CHECK(table.find("psi") == table.find("psi [degrees]"));
}

TEST_CASE("csv: what loggers write for no value is none") {
  const CsvTable table = parse_csv("t,u\n0,--.--\n1,N/A\n2,null\n3,-\n4,-7\n", "run.csv");
  for (std::size_t row = 0; row < 4; ++row) CHECK(std::isnan((*table.find("u"))[row]));
  CHECK((*table.find("u"))[4] == -7.0);
  CHECK(fault(table, "u").empty());
}

TEST_CASE("csv: what is no text is refused as such") {
  CHECK_THROWS_WITH_AS(parse_csv(std::string_view("\x89PNG\x0d\x0a\x1a\x0a\0\0\0", 11), "run.csv"),
                       doctest::Contains("run.csv: this is no text"), InputError);
}

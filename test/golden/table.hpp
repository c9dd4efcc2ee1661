// Golden tables: numbers that a program gave once, kept as CSV beside the tests, and what has moved since.
#pragma once

#include <string>
#include <vector>

namespace fathom::test {

/// Cells are numbers or words. The first column names the row: a time, a quantity.
struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

/// A number as tables have it: nine digits, more than any tolerance asks for.
[[nodiscard]] std::string cell(double number);

/// What a tolerance is a share of.
enum class Of {
  kColumn,  ///< the column's largest number: a series, whose zeros are no more exact than its peaks
  kNumber   ///< the number itself: quantities of different kinds below one another
};

/// One line for each column that has moved by more than `tolerance`, with the largest move and where, and for each row
/// or column that is there in one of the two only. Empty: the same.
[[nodiscard]] std::vector<std::string> moved(const Table& golden, const Table& now, double tolerance, Of of);

/// With its lines of comment ("# ...") left out. Throws where the file cannot be read or its rows are not as long as
/// its header.
[[nodiscard]] Table read_table(const std::string& path);
void write_table(const std::string& path, const Table& table, const std::string& comment);

/// Compares `now` with test/golden/NAME.csv, and fails the test case with what has moved. In a renewal
/// (./check --golden --renew) says what has moved and writes it instead.
void check_golden(const std::string& name, const Table& now, double tolerance, Of of);

}  // namespace fathom::test

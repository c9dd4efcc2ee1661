// Numbers in separated text: a header line of names, then rows of numbers. Commas part the columns, or semicolons (with
// points or commas in the numbers) or tabs where the header has no comma. Lines that begin with # or % are comments;
// the last one before the numbers is the header where no other is there. Fast, strict, and clear about what is wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/paged.hpp"

namespace fathom::tables {

/// What the cells of a column are.
enum class Cells : std::uint8_t {
  kNumbers,
  kDates,      ///< dates with or without a time of day, read as seconds since 1970, UTC
  kTimesOfDay  ///< read as seconds since midnight
};

/// A file as columns. An empty cell and "nan" are NaN; so are "inf", since no instrument measures it, and what loggers
/// write for "no value" ("--.--", "N/A", "null", "-").
struct CsvTable {
  std::string path;
  std::vector<std::string> names;      ///< without the unit
  std::vector<std::string> units;      ///< per name: of "u [m/s]" the unit; empty when the header states none
  std::vector<Cells> cells;            ///< per name
  bool zoneless_dates{};               ///< some date names no zone: taken as UTC
  std::vector<Paged<double>> columns;  ///< one per name, all of the same length
  std::vector<std::string> faults;     ///< per column: what is wrong with its first cell that is no number
  Paged<std::size_t> lines;            ///< line of each row in the file, for messages

  [[nodiscard]] std::size_t rows() const { return lines.size(); }
  /// nullptr when there is no such column; with or without the unit in brackets behind it.
  [[nodiscard]] const Paged<double>* find(std::string_view name) const;
  [[nodiscard]] std::size_t index(const Paged<double>* column) const {
    return static_cast<std::size_t>(column - columns.data());
  }
  /// What a column's cells are; numbers in tables that nobody parsed.
  [[nodiscard]] Cells cells_of(std::size_t column) const {
    return column < cells.size() ? cells[column] : Cells::kNumbers;
  }
  /// "file:line" of a row.
  [[nodiscard]] std::string where(std::size_t row) const;
};

/// Reads a file; InputError "file:line: what" for a missing file, a ragged row, a doubled name, no rows. A cell that is
/// no number is NaN, and a fault of its column: of text that nobody asks for nothing need be said.
[[nodiscard]] CsvTable read_csv(const std::string& path);
/// The same for text; `path` stands for the file in messages.
[[nodiscard]] CsvTable parse_csv(std::string_view text, const std::string& path);

/// "u [m/s]", "psi (deg)" parted into name and unit; no unit where the brackets hold none that is known.
struct NameAndUnit {
  std::string name, unit;
};
[[nodiscard]] NameAndUnit part_unit(std::string_view header);

}  // namespace fathom::tables

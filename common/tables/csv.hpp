// Numbers in separated text: a header line of names, then rows of numbers. Commas part the columns, or semicolons (with
// points or commas in the numbers) or tabs where the header has no comma. Fast, strict, and clear about what is wrong.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::tables {

/// A file as columns. An empty cell and "nan" are NaN; so is "inf", since no instrument measures it.
struct CsvTable {
  std::string path;
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;  ///< one per name, all of the same length
  std::vector<std::string> faults;           ///< per column: what is wrong with its first cell that is no number
  std::vector<std::size_t> lines;            ///< line of each row in the file, for messages

  [[nodiscard]] std::size_t rows() const { return lines.size(); }
  /// nullptr when there is no such column.
  [[nodiscard]] const std::vector<double>* find(std::string_view name) const;
  /// "file:line" of a row.
  [[nodiscard]] std::string where(std::size_t row) const;
};

/// Reads a file; InputError "file:line: what" for a missing file, a ragged row, a doubled name, no rows. A cell that is
/// no number is NaN, and a fault of its column: of text that nobody asks for nothing need be said.
[[nodiscard]] CsvTable read_csv(const std::string& path);
/// The same for text; `path` stands for the file in messages.
[[nodiscard]] CsvTable parse_csv(std::string_view text, const std::string& path);

}  // namespace fathom::tables

// From a table of numbers to a recording: units, frames, flags, held values, and a count of everything that was
// refused.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/samples/recording.hpp"
#include "common/tables/absent.hpp"
#include "common/tables/column_map.hpp"
#include "common/tables/csv.hpp"
#include "common/tables/readers.hpp"

namespace fathom::tables {

struct Imported {
  Recording recording;
  std::vector<std::string> notes;  ///< what was refused, held or left out, one sentence each
  std::string source;
  std::string licence;
};

/// A table with what its columns are, and what was read otherwise than it stands there.
struct MappedTable {
  CsvTable table;
  ColumnMap map;
  std::vector<std::string> notes;
};

/// Reads a file with a map, or as canonical columns when `map_path` is empty.
[[nodiscard]] MappedTable read_mapped(const std::string& csv_path, const std::string& map_path);

/// A table on its way to samples, in slices: of a long one nothing is held but its columns. Components that it lacks
/// are zero where `simulated` says that the vehicle does not move along them, and must not lack otherwise. A row whose
/// time does not rise is dropped; a sample with an empty or NaN cell is refused; both are counted in the notes.
/// InputError for a missing column, a column without a number, a stream without one whole sample (by `finish`).
class TableImport {
 public:
  /// `table` must live as long as this.
  TableImport(const CsvTable& table, ColumnMap map, const std::optional<SimulatedAxes>& simulated);
  ~TableImport();
  TableImport(const TableImport&) = delete;
  TableImport& operator=(const TableImport&) = delete;

  /// The samples of the next `rows` rows at most, into empty streams; all of them where an attitude turns others, which
  /// lie between. False when no row is left.
  bool next(std::size_t rows, Recording& out);
  /// The same of all rows until `end`, with it.
  bool next_until(Utime end, Recording& out);
  /// When the last of the next `rows` rows was, or the last of all; nothing when no row is left.
  [[nodiscard]] std::optional<Utime> end_of_next(std::size_t rows) const;
  /// Whether an attitude turns others: then the first slice is all of it.
  [[nodiscard]] bool all_at_once() const;
  [[nodiscard]] std::size_t rows() const { return rows_.index.size(); }
  [[nodiscard]] std::size_t rows_left() const { return rows_.index.size() - taken_; }
  /// What was refused, held or left out.
  [[nodiscard]] std::vector<std::string> finish();

 private:
  struct Streams;
  const CsvTable& table_;
  ColumnMap map_;
  Resolver resolve_;
  Rows rows_;
  std::size_t taken_{};
  std::unique_ptr<Streams> streams_;
  std::vector<std::string> notes_;
};

/// All of a table.
[[nodiscard]] Imported import_table(const CsvTable& table, ColumnMap map,
                                    const std::optional<SimulatedAxes>& simulated = {});

/// The map of the canonical columns (docs/configuration.md) that the table has, those that its groups lack marked
/// absent; InputError for unknown ones.
[[nodiscard]] ColumnMap canonical_map(const CsvTable& table);

/// Both: a file to a recording.
[[nodiscard]] Imported import_csv(const std::string& csv_path, const std::string& map_path = "",
                                  const std::optional<SimulatedAxes>& simulated = {});

}  // namespace fathom::tables

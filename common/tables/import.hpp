// From a table of numbers to a recording: units, frames, flags, held values, and a count of everything that was
// refused.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/samples/recording.hpp"
#include "common/tables/absent.hpp"
#include "common/tables/column_map.hpp"
#include "common/tables/csv.hpp"

namespace fathom::tables {

struct Imported {
  Recording recording;
  std::vector<std::string> notes;  ///< what was refused, held or left out, one sentence each
  std::string source;
  std::string licence;
};

/// Applies a map. Components that it lacks are zero where `simulated` says that the vehicle does not move along them,
/// and must not lack otherwise. A row whose time does not rise is dropped; a sample with an empty or NaN cell is
/// refused; both are counted in the notes. InputError for a missing column, a column without a number, a stream without
/// one whole sample.
[[nodiscard]] Imported import_table(const CsvTable& table, ColumnMap map,
                                    const std::optional<SimulatedAxes>& simulated = {});

/// The map of the canonical columns (docs/configuration.md) that the table has, those that its groups lack marked
/// absent; InputError for unknown ones.
[[nodiscard]] ColumnMap canonical_map(const CsvTable& table);

/// Reads a file with a map, or as canonical columns when `map_path` is empty.
[[nodiscard]] Imported import_csv(const std::string& csv_path, const std::string& map_path = "",
                                  const std::optional<SimulatedAxes>& simulated = {});

}  // namespace fathom::tables

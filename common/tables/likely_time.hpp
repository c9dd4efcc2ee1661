// Which column of a table looks like its time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/tables/csv.hpp"

namespace fathom::tables {

struct LikelyTime {
  std::vector<std::string> columns;  ///< one, or seconds and nanoseconds
  std::string key;                   ///< of a map: "time: {column: stamp, unit: ms}"
};

/// By its name, and the unit by how far its rows lie apart; nothing where no column looks like it.
[[nodiscard]] std::optional<LikelyTime> likely_time(const CsvTable& table);

}  // namespace fathom::tables

// What the columns of a table are, and the draft of a map of those with usual names.
#pragma once

#include <string>

#include "common/tables/csv.hpp"

namespace fathom::recordings {

/// Columns with count, unit and range as comments of YAML, then a map that runs as it is where a time and at least one
/// stream have usual names; without them the comments alone. Components that no column has are 'none'.
[[nodiscard]] std::string describe_table(const tables::CsvTable& table);

}  // namespace fathom::recordings

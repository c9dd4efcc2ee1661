// Units that a table's header states: "u [cm/s]", "psi (deg)".
#pragma once

#include <string>
#include <vector>

#include "common/tables/csv.hpp"

namespace fathom::tables {

/// Converts canonical columns to SI where their header states another unit; one note for each. InputError for a unit of
/// another dimension, and for one that nobody knows.
[[nodiscard]] std::vector<std::string> to_si(CsvTable& table);

}  // namespace fathom::tables

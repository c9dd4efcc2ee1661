// Recordings and trials as canonical CSV: what import_csv reads without a map. Cells without a value stay empty.
#pragma once

#include <string>

#include "common/samples/recording.hpp"
#include "common/samples/trial.hpp"

namespace fathom::tables {

/// One row per time stamp of any stream. Invalid or held samples become empty cells. The attitude is the pose capture's
/// where there is one, else the attitude sensor's; altitude and estimated states have no canonical column.
[[nodiscard]] std::string to_csv(const Recording& recording);
/// One row per grid point.
[[nodiscard]] std::string to_csv(const Trial& trial);
/// Writes text to a file; InputError when that fails.
void write_file(const std::string& path, const std::string& text);

}  // namespace fathom::tables

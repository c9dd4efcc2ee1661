// A column map as text again, for a map that was mended.
#pragma once

#include <string>

#include "common/tables/column_map.hpp"

namespace fathom::tables {

/// YAML that ColumnMap::parse reads to the same map. InputError for a factor or axes that have no name in a map.
[[nodiscard]] std::string to_yaml(const ColumnMap& map);

}  // namespace fathom::tables

// A column map as text again, for a map that was mended.
#pragma once

#include <string>

#include "common/tables/column_map.hpp"

namespace fathom::tables {

/// YAML that ColumnMap::parse reads to the same map. InputError for a factor or axes that have no name in a map.
[[nodiscard]] std::string to_yaml(const ColumnMap& map);

/// A name as it stands in a map: in quotes where YAML would read it otherwise.
[[nodiscard]] std::string written_name(const std::string& name);

}  // namespace fathom::tables

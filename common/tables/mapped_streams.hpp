// A map for recordings whose topics keep their own times: each stream by itself.
#pragma once

#include <string>
#include <vector>

#include "common/tables/column_map.hpp"

namespace fathom::tables {

/// One stream of a map; `map` holds this stream alone, and its time is without a column unless the stream names one.
struct MappedStream {
  std::string name;   ///< "ahrs"
  std::string where;  ///< "map.yaml:12"
  ColumnMap map;
  std::vector<std::string> columns;  ///< all that the stream names, "topic.field"
};

/// Reads a map whose streams may be lists (rates from one topic, attitude from another) and may have a 'time' of their
/// own; a 'time' of the whole map is that of every stream without. InputError as ColumnMap::load.
[[nodiscard]] std::vector<MappedStream> load_streams(const std::string& path);
[[nodiscard]] std::vector<MappedStream> parse_streams(const std::string& text, const std::string& name);

/// What a map, of either kind, says of commands that have a unit each; empty where it says nothing of such.
[[nodiscard]] std::vector<InputColumns> inputs_of_map(const std::string& path);

}  // namespace fathom::tables

// Topics of a recording as tables: which topic a stream of the map means, and its rows in the order of time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/paged.hpp"
#include "common/recordings/content.hpp"
#include "common/tables/csv.hpp"
#include "common/tables/mapped_streams.hpp"

namespace fathom::recordings {

/// The topic that holds all columns of a stream; what a name was taken for goes to `notes`. InputError where a column
/// is in none and `strict`.
[[nodiscard]] std::optional<std::size_t> topic_of(const tables::MappedStream& stream, const Content& content,
                                                  bool strict, std::vector<std::string>& notes);

/// Rows of one recording of a topic as a table, in the order of time. A message that stands there twice, as in bags
/// whose index was made anew and in files that were joined to themselves, is one; `twice` counts them. Of the last
/// recording the rows are taken over: an hour at 400 Hz must not stand in memory three times.
[[nodiscard]] tables::CsvTable table_of(Content& content, std::size_t topic, std::uint32_t recording,
                                        const Paged<std::int64_t>& times, std::size_t& twice);

}  // namespace fathom::recordings

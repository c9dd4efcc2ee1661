// A log's channels back from the tables that to_csv wrote of them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "common/base/time.hpp"
#include "common/exports/definitions.hpp"

namespace fathom::exports {

/// A table of one channel: its columns are t and the fields of that channel's messages.
struct ChannelTable {
  std::string path, channel;
  const Type* type{};
};

/// By its first line; nothing for a table of any other kind.
[[nodiscard]] std::optional<ChannelTable> channel_table(const std::string& path);

struct Restored {
  std::map<std::string, std::uint64_t> written;  ///< messages by channel
  std::string note;                              ///< what a table does not hold; empty when nothing is missing
};

/// The log from which these tables were exported, event by event, at the times at which they were logged (columns.txt
/// beside them says when the log began; without it each at its own 'utime'). Pictures and signatures, which to_csv only
/// counts, do not come back. The log takes its place when it is whole. InputError "file:line: what" for a cell that
/// cannot be what its column says, or when the log cannot be written.
Restored from_csv(std::span<const ChannelTable> tables, const std::string& log);

/// The line of columns.txt that says when a log began.
[[nodiscard]] std::string line_of_origin(Utime origin);

}  // namespace fathom::exports

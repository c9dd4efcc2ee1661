// An LCM event log, as recorded or as imported, to a Recording.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/samples/recording.hpp"

namespace fathom::wire {

/// What became of one channel's messages.
struct ChannelCount {
  std::uint64_t accepted{};
  std::uint64_t rejected{};        ///< undecodable, a non-finite number, or a quaternion that is not unit
  std::uint64_t first_rejected{};  ///< byte offset of the first of them
  std::uint64_t other_version{};   ///< of another version's type, left out: says nothing of the vehicle's motion
  std::uint64_t late{};            ///< older than the one before; sorted into place
};

struct LogReport {
  std::uint64_t events{};
  std::uint64_t foreign{};  ///< events on channels that no stream of Recording takes
  std::map<std::string, ChannelCount> channels;
  std::string warning;  ///< one line when the last event was cut off; empty otherwise
};

struct LogContents {
  Recording recording;
  LogReport report;
};

/// InputError when the file is damaged, is not an LCM log, holds no channel that Fathom knows, or several recordings
/// that were joined: sorted into one another they would be two vehicles at once.
[[nodiscard]] LogContents read_log(const std::string& path);

/// Up to `most` pictures of a channel, evenly from the first to the last; what cannot be decoded is left out.
[[nodiscard]] std::vector<Camera> read_pictures(const std::string& path, const std::string& channel, std::size_t most);

/// One line per channel with refused or late messages, and the warning; empty when all is well.
[[nodiscard]] std::string complaints(const std::string& path, const LogReport& report);

}  // namespace fathom::wire

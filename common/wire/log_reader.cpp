#include "common/wire/log_reader.hpp"

#include <algorithm>
#include <fathom_lcm/camera_t.hpp>
#include <limits>

#include "common/base/event_log.hpp"
#include "common/wire/log_parts.hpp"

namespace fathom::wire {

LogContents read_log(const std::string& path) {
  LogContents contents;
  LogParts parts{path};
  parts.next(std::numeric_limits<std::size_t>::max(), contents.recording);
  contents.report = parts.report();
  return contents;
}

std::vector<Camera> read_pictures(const std::string& path, const std::string& channel, std::size_t most) {
  std::size_t all = 0;
  EventLog counted{path};
  while (const auto event = counted.next()) all += event->channel == channel ? 1 : 0;
  std::vector<Camera> pictures;
  EventLog log{path};
  for (std::size_t i = 0; i < all && pictures.size() < most;) {
    const auto event = log.next();
    if (!event) break;
    if (event->channel != channel) continue;
    const std::size_t wanted = std::min(all, most), taken = pictures.size();
    // The k-th of n from m: the first, the last, and even steps between them.
    const std::size_t next = wanted > 1 ? taken * (all - 1) / (wanted - 1) : 0;
    if (i++ < next) continue;
    fathom_lcm::camera_t message{};
    const int length = static_cast<int>(event->data.size());
    if (message.decode(event->data.data(), 0, length) != length) continue;
    if (auto picture = decode(message)) pictures.push_back(std::move(*picture));
  }
  return pictures;
}

std::string complaints(const std::string& path, const LogReport& report) {
  std::string text;
  for (const auto& [channel, count] : report.channels) {
    if (count.rejected > 0) {
      text += path + ": channel " + channel + ": " + std::to_string(count.rejected) + " of " +
              std::to_string(count.accepted + count.rejected) +
              " messages refused (non-finite number, wrong length or non-unit quaternion), first at byte " +
              std::to_string(count.first_rejected) + "\n";
    }
    if (count.other_version > 0) {
      text += path + ": channel " + channel + ": " + std::to_string(count.other_version) +
              " messages of another version of Fathom left out\n";
    }
    if (count.late > 0) {
      text += path + ": channel " + channel + ": " + std::to_string(count.late) +
              " messages older than the one before, sorted into place\n";
    }
  }
  if (!report.warning.empty()) text += report.warning + "\n";
  return text;
}

}  // namespace fathom::wire

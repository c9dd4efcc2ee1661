#include "common/wire/log_reader.hpp"

#include <algorithm>
#include <fathom_lcm/camera_t.hpp>
#include <filesystem>
#include <functional>
#include <sstream>
#include <type_traits>

#include "common/base/error.hpp"
#include "common/base/event_log.hpp"
#include "common/wire/streams.hpp"

namespace fathom::wire {
namespace {

struct Stream {
  std::function<void(const LogEvent&)> take;
  ChannelCount count;
};

std::string fingerprint(std::span<const std::uint8_t> bytes) {
  std::ostringstream text;
  text << std::hex;
  for (const unsigned byte : bytes.first(std::min<std::size_t>(bytes.size(), 8))) text << (byte >> 4U) << (byte & 15U);
  return text.str();
}

/// What says nothing of the vehicle's motion: of another version it is left out and counted, and the log can be read.
template <class Sample>
constexpr bool kBeside =
    std::is_same_v<Sample, Answer> || std::is_same_v<Sample, Health> || std::is_same_v<Sample, Operator> ||
    std::is_same_v<Sample, ProcessInfo> || std::is_same_v<Sample, WrenchCommand>;

template <class Message>
bool holds(const LogEvent& event) {
  std::uint64_t stated = 0;
  for (const std::uint64_t byte : event.data.first(std::min<std::size_t>(event.data.size(), 8))) {
    stated = stated << 8U | byte;
  }
  return event.data.size() < 8 || stated == static_cast<std::uint64_t>(Message::getHash());
}

template <class Message>
[[noreturn]] void refuse_version(const std::string& path, const LogEvent& event) {
  throw InputError(path + ": byte " + std::to_string(event.offset) + ": channel " + std::string{event.channel} +
                   " does not hold this version's " + Message::getTypeName() + " (fingerprint " +
                   fingerprint(event.data) +
                   "); read the log with the version of Fathom that made it, or, if another program did, with "
                   "'fathom import --types ITS.lcm'");
}

template <class Sample>
bool take(const LogEvent& event, std::vector<Sample>& stream, ChannelCount& count) {
  MessageOf<Sample> message{};
  const int length = static_cast<int>(event.data.size());
  if (message.decode(event.data.data(), 0, length) != length) return false;
  std::optional<Sample> sample = decode(message);
  if (!sample || !is_time(sample->utime)) return false;
  if (!stream.empty() && sample->utime < stream.back().utime) ++count.late;
  stream.push_back(std::move(*sample));
  return true;
}

}  // namespace

LogContents read_log(const std::string& path) {
  LogContents contents;
  contents.recording.name = std::filesystem::path{path}.stem().string();
  std::map<std::string, Stream, std::less<>> streams;
  visit_streams(contents.recording, [&](const char* channel, auto& samples) {
    using Sample = typename std::remove_reference_t<decltype(samples)>::value_type;
    Stream& stream = streams[channel];
    stream.take = [&path, &samples, &count = stream.count](const LogEvent& event) {
      if (!holds<MessageOf<Sample>>(event)) {
        if constexpr (!kBeside<Sample>) refuse_version<MessageOf<Sample>>(path, event);
        ++count.other_version;
      } else if (take(event, samples, count)) {
        ++count.accepted;
      } else if (count.rejected++ == 0) {
        count.first_rejected = event.offset;
      }
    };
  });

  EventLog log{path};
  bool known = false;
  while (const auto event = log.next()) {
    if (event->begins_anew) {
      throw InputError(path + ": holds several recordings joined together: another one begins at event " +
                       std::to_string(log.events()) + " (byte " + std::to_string(event->offset) +
                       "). Part them with: fathom repair-log LOG --out PART.lcmlog");
    }
    known = known || event->channel == kCamera;
    const auto found = streams.find(event->channel);
    if (found == streams.end()) {
      ++contents.report.foreign;
      continue;
    }
    found->second.take(*event);
  }
  contents.report.events = log.events();
  contents.report.warning = log.warning();
  for (const auto& [channel, stream] : streams) {
    if (stream.count.accepted + stream.count.rejected + stream.count.other_version > 0)
      contents.report.channels.emplace(channel, stream.count);
  }
  if (contents.report.channels.empty() && !known) {
    throw InputError(path + ": none of its " + std::to_string(log.events()) +
                     " events is on a channel that Fathom knows (docs/messages.md); was another program's bus "
                     "recorded? 'fathom import --types ITS.lcm' reads it");
  }
  visit_streams(contents.recording, [](const char*, auto& samples) {
    const auto older = [](const auto& a, const auto& b) { return a.utime < b.utime; };
    if (!std::is_sorted(samples.begin(), samples.end(), older)) {
      std::stable_sort(samples.begin(), samples.end(), older);
    }
  });
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

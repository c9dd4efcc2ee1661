#include "common/wire/log_parts.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/event_log.hpp"

namespace fathom::wire {
namespace {

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
std::optional<Sample> sample_of(const LogEvent& event) {
  MessageOf<Sample> message{};
  const int length = static_cast<int>(event.data.size());
  if (message.decode(event.data.data(), 0, length) != length) return {};
  std::optional<Sample> sample = decode(message);
  if (sample && !is_time(sample->utime)) return {};
  return sample;
}

}  // namespace

struct LogParts::Reader {
  struct Stream {
    std::function<std::size_t(const LogEvent&)> take;  ///< bytes that its sample takes
    ChannelCount count;
    Utime latest{std::numeric_limits<Utime>::min()};  ///< of the sample before
  };

  explicit Reader(const std::string& path) : log{path}, size{std::filesystem::file_size(path)} {
    visit_streams(part, [&](const char* channel, auto& samples) {
      using Sample = typename std::remove_reference_t<decltype(samples)>::value_type;
      Stream& stream = streams[channel];
      stream.take = [this, &samples, &stream](const LogEvent& event) { return keep<Sample>(event, samples, stream); };
    });
  }

  template <class Sample>
  std::size_t keep(const LogEvent& event, std::vector<Sample>& samples, Stream& stream) {
    ChannelCount& count = stream.count;
    if (!holds<MessageOf<Sample>>(event)) {
      if constexpr (!kBeside<Sample>) refuse_version<MessageOf<Sample>>(log.path(), event);
      ++count.other_version;
      return 0;
    }
    std::optional<Sample> sample = sample_of<Sample>(event);
    if (!sample) {
      if (count.rejected++ == 0) count.first_rejected = event.offset;
      return 0;
    }
    if (sample->utime < stream.latest) ++count.late;
    stream.latest = sample->utime;
    samples.push_back(std::move(*sample));
    ++count.accepted;
    return bytes_of(samples.back());
  }

  [[nodiscard]] LogReport report() const {
    LogReport report{.events = log.events(), .foreign = foreign, .channels = {}, .warning = log.warning()};
    for (const auto& [channel, stream] : streams) {
      if (stream.count.accepted + stream.count.rejected + stream.count.other_version > 0)
        report.channels.emplace(channel, stream.count);
    }
    return report;
  }

  EventLog log;
  Recording part;  ///< into which the streams go
  std::map<std::string, Stream, std::less<>> streams;
  std::uint64_t foreign{};
  std::uint64_t size{}, at{};  ///< of the file, of the event that was read last
  bool pictures{}, ended{};
};

LogParts::LogParts(const std::string& path) : reader_{std::make_unique<Reader>(path)} {}
LogParts::~LogParts() = default;

LogReport LogParts::report() const { return reader_->report(); }
double LogParts::share() const {
  return reader_->ended ? 1.0 : static_cast<double>(reader_->at) / static_cast<double>(reader_->size);
}

bool LogParts::next(std::size_t most, Recording& part) {
  Reader& reader = *reader_;
  const std::string& path = reader.log.path();
  if (reader.ended) return false;
  for (std::size_t bytes = 0; bytes < most;) {
    const auto event = reader.log.next();
    if (!event) {
      reader.ended = true;
      break;
    }
    if (event->begins_anew) {
      throw InputError(path + ": holds several recordings joined together: another one begins at event " +
                       std::to_string(reader.log.events()) + " (byte " + std::to_string(event->offset) +
                       "). Part them with: fathom repair-log LOG --out PART.lcmlog");
    }
    reader.at = event->offset;
    reader.pictures = reader.pictures || event->channel == kCamera;
    const auto found = reader.streams.find(event->channel);
    if (found == reader.streams.end()) {
      ++reader.foreign;
    } else {
      bytes += found->second.take(*event);
    }
  }
  if (reader.ended && !reader.pictures && reader.report().channels.empty()) {
    throw InputError(path + ": none of its " + std::to_string(reader.log.events()) +
                     " events is on a channel that Fathom knows (docs/messages.md); was another program's bus "
                     "recorded? 'fathom import --types ITS.lcm' reads it");
  }
  put_in_order(reader.part);
  visit_streams(reader.part, [](const char*, auto& samples) {
    samples.shrink_to_fit();  // what a long stream has grown by is up to as much again
  });
  part = std::exchange(reader.part, {});
  part.name = std::filesystem::path{path}.stem().string();
  return true;
}

}  // namespace fathom::wire

#include "common/wire/log_writer.hpp"

#include <algorithm>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <vector>

#include "common/base/error.hpp"
#include "common/wire/streams.hpp"

namespace fathom::wire {
namespace {

struct Entry {
  Utime utime{};
  const char* channel{};
  const void* sample{};
  void (*encode_into)(const void* sample, std::vector<std::uint8_t>& bytes){};
};

template <class Sample>
void encode_sample(const void* sample, std::vector<std::uint8_t>& bytes) {
  const MessageOf<Sample> message = encode(*static_cast<const Sample*>(sample));
  const int length = message.getEncodedSize();
  bytes.resize(static_cast<std::size_t>(length));
  message.encode(bytes.data(), 0, length);
}

std::vector<Entry> in_order_of_time(const Recording& recording) {
  std::vector<Entry> entries;
  visit_streams(recording, [&](const char* channel, const auto& samples) {
    using Sample = typename std::remove_cvref_t<decltype(samples)>::value_type;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Sample& sample = samples[i];
      if (!decode(encode(sample))) {
        throw InputError(recording.name + ": channel " + channel + ": sample " + std::to_string(i) + " at utime " +
                         std::to_string(sample.utime) +
                         " holds a non-finite number or a quaternion that is not unit; leave it out");
      }
      entries.push_back({sample.utime, channel, &sample, &encode_sample<Sample>});
    }
  });
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.utime < b.utime; });
  return entries;
}

}  // namespace

std::uint64_t write_log(const Recording& recording, const std::string& path) {
  const std::vector<Entry> entries = in_order_of_time(recording);
  lcm::LogFile log{path, "w"};
  if (!log.good()) throw InputError(path + ": cannot be written; check that the folder exists and is yours");
  std::vector<std::uint8_t> bytes;
  lcm::LogEvent event{};
  bool written = true;
  for (const Entry& entry : entries) {
    entry.encode_into(entry.sample, bytes);
    event.timestamp = entry.utime;
    event.channel = entry.channel;
    event.datalen = static_cast<std::int32_t>(bytes.size());
    event.data = bytes.data();
    written = written && log.writeEvent(&event) == 0;
  }
  if (!written || std::fflush(log.getFilePtr()) != 0) throw InputError(path + ": writing failed; is the disk full?");
  return entries.size();
}

}  // namespace fathom::wire

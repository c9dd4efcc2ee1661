#include "common/recordings/rosbag1/rosbag1.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/recordings/little.hpp"
#include "common/recordings/ros/channels.hpp"
#include "common/recordings/unpack.hpp"

namespace fathom::recordings::rosbag1 {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::string_view kAnyVersion = "#ROSBAG V";
constexpr std::size_t kMostHeader = 65536;                    // bytes
constexpr std::uint32_t kMostData = std::uint32_t{1} << 30U;  // bytes of a record
enum Op : std::uint8_t { kMessage = 2, kBagHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

/// Fields "name=value" of a header.
using Fields = std::map<std::string, Bytes, std::less<>>;

bool fields_of(Bytes header, Fields& fields) {
  fields.clear();
  while (!header.empty()) {
    if (header.size() < 4) return false;
    const auto length = little<std::uint32_t>(header);
    if (length > header.size() - 4) return false;
    const Bytes field = header.subspan(4, length);
    const auto equal = std::find(field.begin(), field.end(), std::uint8_t{'='});
    if (equal == field.end() || equal == field.begin()) return false;
    const auto at = static_cast<std::size_t>(equal - field.begin());
    fields[std::string{field.begin(), equal}] = field.subspan(at + 1);
    header = header.subspan(4 + length);
  }
  return true;
}

std::string text_of(const Fields& fields, std::string_view name) {
  const auto found = fields.find(name);
  return found == fields.end() ? "" : std::string{found->second.begin(), found->second.end()};
}

template <class T>
std::optional<T> number_of(const Fields& fields, std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.size() != sizeof(T)) return std::nullopt;
  return little<T>(found->second);
}

/// A record where its parts are: all there, or its data cut off by the end.
struct Record {
  Fields fields;
  std::uint8_t op{};
  Bytes data;
  std::uint64_t data_length{};
  std::uint64_t length{};  ///< of the whole record
};

class Reader {
 public:
  Reader(const std::string& path, Sink& sink, Damage& damage) : file_(path), damage_(damage), channels_(sink, damage) {}

  void run() {
    const Bytes head = file_.at(0, kMagic.size());
    if (!std::equal(kMagic.begin(), kMagic.end(), head.begin(), head.end()))
      throw InputError(file_.path() + ": a ROS bag of another version than 2.0; 'rosbag migrate' of ROS 1 rewrites it");
    std::uint64_t at = kMagic.size();
    std::uint64_t lost_from = 0;
    bool lost = false;
    while (at < file_.size()) {
      Record record;
      const bool found = record_at(at, record);
      const bool cut = found && record.length > file_.size() - at;
      if (!found || (lost && cut)) {
        if (!lost) lost_from = at;
        lost = true;
        ++at;
        continue;
      }
      if (lost) damage_.add("stretches of bytes that are no record", lost_from, at - lost_from);
      lost = false;
      if (cut) damage_.add("records cut off by the end of the file", at, file_.size() - at);
      take(at, record, cut, true);
      at = cut ? file_.size() : at + record.length;
    }
    if (lost) damage_.add("stretches of bytes that are no record", lost_from, file_.size() - lost_from);
  }

 private:
  struct Connection {
    std::size_t channel{};
  };

  /// A record in the file; false where none can begin.
  bool record_at(std::uint64_t at, Record& record) {
    const Bytes size = file_.at(at, 4);
    if (size.size() < 4) return false;
    const auto header_length = little<std::uint32_t>(size);
    if (header_length < 5 || header_length > kMostHeader) return false;
    Bytes bytes = file_.at(at, 8 + header_length);
    if (bytes.size() < 8 + header_length || !fields_of(bytes.subspan(4, header_length), record.fields)) return false;
    const auto op = number_of<std::uint8_t>(record.fields, "op");
    if (!op) return false;
    record.data_length = little<std::uint32_t>(bytes, 4 + header_length);
    if (record.data_length > kMostData) return false;
    record.op = *op;
    record.length = 8 + header_length + record.data_length;
    // Once more with the data: the window may have moved.
    bytes = file_.at(at, static_cast<std::size_t>(std::min(record.length, file_.size() - at)));
    if (!fields_of(bytes.subspan(4, header_length), record.fields)) return false;
    record.data = bytes.subspan(8 + header_length);
    return true;
  }

  void take(std::uint64_t at, const Record& record, bool cut, bool outside) {
    switch (record.op) {
      case kConnection:
        if (!cut) connection(record);
        return;
      case kMessage:
        if (!cut) message(at, record);
        return;
      case kChunk:
        if (outside) chunk(at, record, cut);
        return;
      default:
        return;
    }
  }

  void connection(const Record& record) {
    const auto id = number_of<std::uint32_t>(record.fields, "conn");
    Fields about;
    if (!id || !fields_of(record.data, about)) return damage_.add("connections that cannot be understood");
    if (connections_.contains(*id)) return;  // said again in the index
    std::string topic = text_of(record.fields, "topic");
    if (topic.empty()) topic = text_of(about, "topic");
    connections_[*id] = {channels_.open(topic, text_of(about, "type"), text_of(about, "message_definition"),
                                        ros::Language::kMsg, ros::Layout::kRos1)};
  }

  void message(std::uint64_t at, const Record& record) {
    const auto id = number_of<std::uint32_t>(record.fields, "conn");
    const auto time = number_of<std::uint64_t>(record.fields, "time");
    const auto found = id ? connections_.find(*id) : connections_.end();
    if (!time || found == connections_.end())
      return damage_.add("messages of a connection that is not described", at, record.length);
    const std::uint64_t seconds = *time & 0xFFFFFFFFU, nanoseconds = *time >> 32U;
    channels_.message(found->second.channel, static_cast<std::int64_t>(seconds * 1'000'000 + nanoseconds / 1000),
                      record.data);
  }

  void chunk(std::uint64_t at, const Record& record, bool cut) {
    const std::string name = text_of(record.fields, "compression");
    const auto size = number_of<std::uint32_t>(record.fields, "size");
    Packing packing = Packing::kNone;
    if (name == "bz2") {
      packing = Packing::kBz2;
    } else if (name == "lz4") {
      packing = Packing::kLz4;
    } else if (name != "none") {
      const std::string what = "chunks packed by '" + name + "', which is not known here";
      if (cut) return damage_.add(what);  // its bytes are counted as cut off
      return damage_.add(what, at, record.length);
    }
    Bytes records = record.data;
    if (packing != Packing::kNone) {
      unpack(packing, record.data, size ? std::min(*size, kMostData) : kMostData, unpacked_);
      records = unpacked_.bytes;
    }
    const bool whole = !cut && (packing == Packing::kNone || (size && records.size() == *size));
    if (!cut && !whole) damage_.add("chunks that cannot be unpacked to the end", at, record.length);
    while (records.size() >= 8) {
      const auto header_length = little<std::uint32_t>(records);
      if (header_length > records.size() - 8) break;
      Record inner;
      if (!fields_of(records.subspan(4, header_length), inner.fields)) break;
      inner.data_length = little<std::uint32_t>(records, 4 + header_length);
      if (inner.data_length > records.size() - 8 - header_length) break;
      inner.op = number_of<std::uint8_t>(inner.fields, "op").value_or(0);
      inner.length = 8 + header_length + inner.data_length;
      inner.data = records.subspan(8 + header_length, static_cast<std::size_t>(inner.data_length));
      take(at, inner, false, false);
      records = records.subspan(static_cast<std::size_t>(inner.length));
    }
    if (whole && !records.empty()) damage_.add("chunks whose records are damaged", at, records.size());
  }

  FileWindow file_;
  Damage& damage_;
  ros::Channels channels_;
  std::map<std::uint32_t, Connection> connections_;
  Unpacked unpacked_;
};

}  // namespace

bool is_bag(Bytes head) {
  return head.size() >= kAnyVersion.size() && std::equal(kAnyVersion.begin(), kAnyVersion.end(), head.begin());
}

void read(const std::string& path, Sink& sink, Damage& damage) { Reader{path, sink, damage}.run(); }

}  // namespace fathom::recordings::rosbag1

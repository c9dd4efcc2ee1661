#include "common/recordings/mcap/mcap.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>

#include "common/base/error.hpp"
#include "common/recordings/little.hpp"
#include "common/recordings/ros/channels.hpp"
#include "common/recordings/unpack.hpp"

namespace fathom::recordings::mcap {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', 0x30, '\r', '\n'};
constexpr std::size_t kHeader = 9;                             // opcode and length
constexpr std::uint64_t kMostChunk = std::uint64_t{1} << 30U;  // bytes, packed or not
enum Opcode : std::uint8_t {
  kFileHeader = 1,
  kFooter,
  kSchema,
  kChannel,
  kMessage,
  kChunk,
  kLastKnown = 0x0F,
  kPrivate = 0x80
};

/// Takes fields off the front; once one is missing all are.
class Cursor {
 public:
  explicit Cursor(Bytes bytes) : bytes_(bytes) {}
  template <class T>
  T number() {
    if (bytes_.size() < sizeof(T)) {
      good_ = false;
      bytes_ = {};
      return {};
    }
    const T value = little<T>(bytes_);
    bytes_ = bytes_.subspan(sizeof(T));
    return value;
  }
  Bytes bytes(std::uint64_t count) {
    if (count > bytes_.size()) {
      good_ = false;
      bytes_ = {};
      return {};
    }
    const Bytes taken = bytes_.first(static_cast<std::size_t>(count));
    bytes_ = bytes_.subspan(static_cast<std::size_t>(count));
    return taken;
  }
  std::string text() {
    const Bytes taken = bytes(number<std::uint32_t>());
    return {taken.begin(), taken.end()};
  }
  [[nodiscard]] Bytes rest() const { return bytes_; }
  [[nodiscard]] bool good() const { return good_; }

 private:
  Bytes bytes_;
  bool good_{true};
};

std::optional<Packing> packing_of(const std::string& name) {
  if (name.empty() || name == "none") return Packing::kNone;
  if (name == "zstd") return Packing::kZstd;
  if (name == "lz4") return Packing::kLz4;
  return std::nullopt;
}

class Reader {
 public:
  Reader(const std::string& path, Sink& sink, Damage& damage) : file_(path), damage_(damage), channels_(sink, damage) {}

  void run() {
    std::uint64_t at = kMagic.size();
    std::uint64_t lost_from = 0;
    bool lost = false;
    while (at < file_.size()) {
      const Bytes head = file_.at(at, kHeader);
      if (is_mcap(head)) {  // the end, or another file behind it
        at += kMagic.size();
        continue;
      }
      const std::uint64_t left = file_.size() - at;
      if (!lost && known(head)) {
        const auto length = little<std::uint64_t>(head, 1);
        if (length > left - kHeader && goes_on_behind(at)) {  // its length is damaged
          lost_from = at++;
          lost = true;
          continue;
        }
        if (length > left - kHeader) {
          cut_off(at, left);
          return;
        }
        if (head[0] == kChunk && length > kMostChunk) {
          damage_.add("chunks of more than a gigabyte", at, length);
        } else if (head[0] == kChunk || head[0] <= kMessage) {
          record(head[0], at, file_.at(at + kHeader, static_cast<std::size_t>(length)), true);
        }
        at += kHeader + length;
        continue;
      }
      if (lost && begins_chunk(at, left)) {
        damage_.add("stretches of bytes that are no record", lost_from, at - lost_from);
        lost = false;
        continue;
      }
      if (!lost) lost_from = at;
      lost = true;
      ++at;
    }
    if (lost) damage_.add("stretches of bytes that are no record", lost_from, file_.size() - lost_from);
  }

 private:
  struct Schema {
    std::string name, encoding, text;
  };

  [[nodiscard]] static bool known(Bytes head) {
    return head.size() == kHeader && head[0] != 0 && (head[0] <= kLastKnown || head[0] >= kPrivate) &&
           little<std::uint64_t>(head, 1) < (std::uint64_t{1} << 40U);
  }

  /// A chunk whose sizes and packing make sense: where reading goes on behind damage.
  bool begins_chunk(std::uint64_t at, std::uint64_t left) {
    const Bytes bytes = file_.at(at, 64);
    if (bytes.size() < 64 || bytes[0] != kChunk) return false;
    const auto length = little<std::uint64_t>(bytes, 1);
    if (length > left - kHeader || length > kMostChunk) return false;
    Cursor cursor{bytes.subspan(kHeader)};
    const auto begin = cursor.number<std::uint64_t>(), end = cursor.number<std::uint64_t>();
    (void)cursor.number<std::uint64_t>();
    (void)cursor.number<std::uint32_t>();
    const std::string packing = cursor.text();
    const auto size = cursor.number<std::uint64_t>();
    return cursor.good() && begin <= end && packing_of(packing) &&
           8 + 8 + 8 + 4 + 4 + packing.size() + 8 + size == length;
  }

  /// Whether a whole chunk begins somewhere behind.
  bool goes_on_behind(std::uint64_t at) {
    for (++at; at < file_.size(); ++at) {
      const Bytes rest = file_.rest(at);
      at += static_cast<std::uint64_t>(std::find(rest.begin(), rest.end(), std::uint8_t{kChunk}) - rest.begin());
      if (at < file_.size() && begins_chunk(at, file_.size() - at)) return true;
    }
    return false;
  }

  /// What the end of the file cuts off: of a chunk all that can be unpacked is kept.
  void cut_off(std::uint64_t at, std::uint64_t left) {
    damage_.add("records cut off by the end of the file", at, left);
    const Bytes bytes = file_.at(at, static_cast<std::size_t>(std::min(left, kMostChunk)));
    if (bytes.size() > kHeader && bytes[0] == kChunk) chunk(at, bytes.subspan(kHeader), false);
  }

  void record(std::uint8_t opcode, std::uint64_t at, Bytes body, bool outside) {
    switch (opcode) {
      case kSchema:
        return schema(body);
      case kChannel:
        return channel(body);
      case kMessage:
        return message(at, body);
      case kChunk:
        if (outside) chunk(at, body, true);
        return;
      default:
        return;
    }
  }

  void schema(Bytes body) {
    Cursor cursor{body};
    const auto id = cursor.number<std::uint16_t>();
    Schema schema{.name = cursor.text(), .encoding = cursor.text(), .text = {}};
    const Bytes text = cursor.bytes(cursor.number<std::uint32_t>());
    schema.text.assign(text.begin(), text.end());
    if (cursor.good() && id != 0) schemas_[id] = std::move(schema);
  }

  void channel(Bytes body) {
    Cursor cursor{body};
    const auto id = cursor.number<std::uint16_t>();
    const auto schema_id = cursor.number<std::uint16_t>();
    const std::string topic = cursor.text();
    const std::string encoding = cursor.text();
    if (!cursor.good()) return;
    const auto found = schemas_.find(schema_id);
    const Schema schema = found == schemas_.end() ? Schema{} : found->second;
    const bool ros1 = encoding == "ros1";
    const bool msg = schema.encoding == "ros2msg" || schema.encoding == "ros1msg";
    if ((encoding != "cdr" && !ros1) || (!msg && schema.encoding != "ros2idl" && schema.encoding != "omgidl")) {
      opened_[id] = channels_.open_unread(
          topic, schema.name,
          "whose encoding '" + encoding + "' with definitions '" + schema.encoding + "' is not read here");
      return;
    }
    opened_[id] = channels_.open(topic, schema.name, schema.text, msg ? ros::Language::kMsg : ros::Language::kIdl,
                                 ros1 ? ros::Layout::kRos1 : ros::Layout::kCdr);
  }

  void message(std::uint64_t at, Bytes body) {
    Cursor cursor{body};
    const auto id = cursor.number<std::uint16_t>();
    (void)cursor.number<std::uint32_t>();
    const auto log = cursor.number<std::uint64_t>();
    (void)cursor.number<std::uint64_t>();
    const auto found = opened_.find(id);
    if (!cursor.good() || found == opened_.end()) {
      damage_.add(cursor.good() ? "messages of a channel that is not described" : "messages too short to be one", at,
                  body.size());
      return;
    }
    channels_.message(found->second, static_cast<std::int64_t>(log / 1000), cursor.rest());
  }

  void chunk(std::uint64_t at, Bytes body, bool whole) {
    Cursor cursor{body};
    (void)cursor.number<std::uint64_t>();
    (void)cursor.number<std::uint64_t>();
    const auto size = cursor.number<std::uint64_t>();
    const auto crc = cursor.number<std::uint32_t>();
    const std::string name = cursor.text();
    const auto packed_size = cursor.number<std::uint64_t>();
    if (!cursor.good()) return;
    const std::optional<Packing> packing = packing_of(name);
    if (!packing) {
      damage_.add("chunks packed by '" + name + "', which is not known here", at, body.size());
      return;
    }
    const Bytes packed = whole ? cursor.bytes(packed_size) : cursor.rest();
    Bytes records = packed;
    if (*packing != Packing::kNone) {
      unpack(*packing, packed, static_cast<std::size_t>(std::min(size, kMostChunk)), unpacked_);
      records = unpacked_.bytes;
    }
    if (whole && !cursor.good()) {
      damage_.add("chunks that contradict their own length", at, body.size());
      return;
    }
    if (whole && crc != 0 && crc32(records) != crc) {
      // Which of its numbers is wrong nobody can say; the bytes of its records may still be whole in part.
      damage_.add("chunks whose checksum is wrong", at, body.size());
      return;
    }
    if (whole && records.size() != size) damage_.add("chunks that cannot be unpacked to the end", at, body.size());
    while (records.size() >= kHeader) {
      const auto length = little<std::uint64_t>(records, 1);
      if (length > records.size() - kHeader) break;
      record(records[0], at, records.subspan(kHeader, static_cast<std::size_t>(length)), false);
      records = records.subspan(kHeader + static_cast<std::size_t>(length));
    }
  }

  FileWindow file_;
  Damage& damage_;
  ros::Channels channels_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::size_t> opened_;
  Unpacked unpacked_;
};

}  // namespace

bool is_mcap(Bytes head) {
  return head.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), head.begin());
}

void read(const std::string& path, Sink& sink, Damage& damage) { Reader{path, sink, damage}.run(); }

}  // namespace fathom::recordings::mcap

#include "common/recordings/tlog/tlog.hpp"

#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "common/devices/checksum.hpp"
#include "common/devices/mavlink/definitions.hpp"
#include "common/recordings/little.hpp"

namespace fathom::recordings::tlog {
namespace {

namespace mavlink = devices::mavlink;

constexpr std::size_t kStamp = 8;
constexpr std::uint8_t kMagic1 = 0xFE, kMagic2 = 0xFD;
constexpr std::size_t kSignature = 13;
constexpr std::size_t kLongest = kStamp + 10 + 255 + 2 + kSignature;
constexpr std::uint64_t kEarliest = 946'684'800'000'000, kLatestStamp = 4'102'444'800'000'000;  // us: 2000, 2100
constexpr std::uint64_t kNear = 86'400'000'000;                                                 // us: a day
constexpr int kSearched = 5000;  // frames within which a vehicle shows itself by its heartbeat

struct Frame {
  std::uint64_t stamp{};
  std::uint32_t id{};
  int system{}, component{};
  Bytes payload;
  std::size_t length{};  ///< with its stamp
  bool checked{};        ///< its checksum is right
  const mavlink::Definition* definition{};
};

/// What looks like a stamp and a whole frame at the beginning.
std::optional<Frame> frame_at(Bytes bytes) {
  if (bytes.size() < kStamp + 8) return std::nullopt;
  Frame frame{.stamp = big<std::uint64_t>(bytes)};
  if (frame.stamp < kEarliest || frame.stamp > kLatestStamp) return std::nullopt;
  const Bytes wire = bytes.subspan(kStamp);
  if (wire[0] != kMagic1 && wire[0] != kMagic2) return std::nullopt;
  const std::size_t header = wire[0] == kMagic1 ? 6 : 10;
  if (wire.size() < header + 2) return std::nullopt;
  std::size_t trailer = 2;
  if (wire[0] == kMagic2) {
    if (wire[2] > 1) return std::nullopt;
    trailer += (wire[2] & 1U) != 0 ? kSignature : 0;
    frame.system = wire[5];
    frame.component = wire[6];
    frame.id = wire[7] | static_cast<std::uint32_t>(wire[8]) << 8U | static_cast<std::uint32_t>(wire[9]) << 16U;
  } else {
    frame.system = wire[3];
    frame.component = wire[4];
    frame.id = wire[5];
  }
  const std::size_t payload = wire[1];
  if (wire.size() < header + payload + trailer) return std::nullopt;
  frame.payload = wire.subspan(header, payload);
  frame.length = kStamp + header + payload + trailer;
  frame.definition = mavlink::definition(frame.id);
  if (frame.definition != nullptr) {
    const std::uint16_t crc = devices::crc16_reflected(wire.subspan(1, header - 1 + payload), 0xFFFF);
    const std::uint8_t extra[]{frame.definition->crc_extra};
    frame.checked = devices::crc16_reflected(extra, crc) == little<std::uint16_t>(wire, header + payload);
  }
  return frame;
}

bool near(std::uint64_t a, std::uint64_t b) { return (a > b ? a - b : b - a) < kNear; }

/// Goes from frame to frame; tells what stands between them.
class Frames {
 public:
  Frames(FileWindow& file, Damage& damage) : file_(file), damage_(damage) {}

  std::optional<Frame> next() {
    std::optional<Frame> found;
    while (at_ < file_.size() && !found) {
      const Bytes bytes = file_.at(at_, 2 * kLongest);
      std::optional<Frame> frame = frame_at(bytes);
      const bool believed = frame && (frame->checked || followed(bytes, *frame));
      if (!believed) {
        if (lost_ == 0) lost_from_ = at_;
        ++lost_;
        ++at_;
        continue;
      }
      close();
      if (!frame->checked) {
        const std::string name =
            frame->definition != nullptr ? std::string{frame->definition->name} : "number " + std::to_string(frame->id);
        damage_.add(frame->definition != nullptr ? "frames of " + name + " with a wrong checksum"
                                                 : "frames of message " + name + ", which is in no dialect known here",
                    at_, frame->length);
      } else {
        found = frame;
      }
      last_ = frame->stamp;
      at_ += frame->length;
    }
    if (!found) close();
    return found;
  }

 private:
  /// Whether another frame, or the end of the file, stands right behind.
  [[nodiscard]] bool followed(Bytes bytes, const Frame& frame) const {
    if (last_ && !near(*last_, frame.stamp)) return false;
    if (at_ + frame.length == file_.size()) return true;
    const std::optional<Frame> behind = frame_at(bytes.subspan(frame.length));
    return behind && near(behind->stamp, frame.stamp);
  }

  void close() {
    if (lost_ == 0) return;
    const bool end = at_ >= file_.size() && lost_ < kLongest;
    damage_.add(end ? "frames cut off by the end of the file" : "stretches of bytes that are no frame", lost_from_,
                lost_);
    lost_ = 0;
  }

  FileWindow& file_;
  Damage& damage_;
  std::uint64_t at_{}, lost_{}, lost_from_{};
  std::optional<std::uint64_t> last_;
};

double number(char letter, Bytes bytes, std::size_t at) {
  switch (letter) {
    case 'B':
    case 'c':
      return bytes[at];
    case 'b':
      return static_cast<std::int8_t>(bytes[at]);
    case 'H':
      return little<std::uint16_t>(bytes, at);
    case 'h':
      return little<std::int16_t>(bytes, at);
    case 'I':
      return little<std::uint32_t>(bytes, at);
    case 'i':
      return little<std::int32_t>(bytes, at);
    case 'Q':
      return static_cast<double>(little<std::uint64_t>(bytes, at));
    case 'q':
      return static_cast<double>(little<std::int64_t>(bytes, at));
    case 'f':
      return static_cast<double>(little<float>(bytes, at));
    default:
      return little<double>(bytes, at);
  }
}

/// Who speaks for the vehicle: the first that is an autopilot by its heartbeat.
std::pair<int, int> vehicle_of(FileWindow& file) {
  constexpr std::size_t kAutopilot = 5;
  constexpr std::uint8_t kNoAutopilot = 8;
  Damage ignored;
  Frames frames{file, ignored};
  for (int i = 0; i < kSearched; ++i) {
    const std::optional<Frame> frame = frames.next();
    if (!frame) break;
    if (frame->id == 0 && frame->payload.size() > kAutopilot && frame->payload[kAutopilot] != kNoAutopilot)
      return {frame->system, frame->component};
  }
  return {1, 1};
}

class Reader {
 public:
  Reader(std::pair<int, int> vehicle, Sink& sink) : vehicle_(vehicle), sink_(sink) {}

  void take(const Frame& frame) {
    padded_.fill(0);  // zero bytes at the end of a payload are not sent
    std::copy(frame.payload.begin(), frame.payload.end(), padded_.begin());
    const std::string part = part_of(frame);
    auto found = kinds_.find(std::tuple{frame.id, frame.system, frame.component, part});
    if (found == kinds_.end())
      found = kinds_.emplace(std::tuple{frame.id, frame.system, frame.component, part}, make(frame, part)).first;
    Kind& kind = found->second;
    values_.clear();
    if (kind.wanted) {
      for (const mavlink::DefinedField& field : frame.definition->fields) {
        if (field.letter == 'c' && field.list) {
          if (!kind.said) sink_.text(kind.topic, field.name, words(field));
          kind.said = true;
          continue;
        }
        const std::size_t size = mavlink::size_of(field.letter);
        // Extensions that an older sender does not know are not sent, and neither are zeros: no number is made of that.
        for (std::size_t i = 0; i < field.count; ++i) {
          const std::size_t at = field.offset + i * size;
          values_.push_back(field.extension && at >= frame.payload.size() ? std::nan("")
                                                                          : number(field.letter, padded_, at));
        }
      }
      if (kind.rate) add_rate();
    }
    sink_.message(kind.topic, {static_cast<std::int64_t>(frame.stamp), measured(kind)}, values_);
  }

 private:
  struct Kind {
    std::size_t topic{};
    bool wanted{};
    bool said{};
    const mavlink::DefinedField* time{};
    bool rate{};  ///< VISION_POSITION_DELTA: its shift over its time is a velocity
    std::uint64_t last{}, wraps{};
  };
  static constexpr std::uint32_t kVisionDelta = 11011;

  [[nodiscard]] std::string words(const mavlink::DefinedField& field) const {
    std::string text;
    for (std::size_t i = 0; i < field.count && padded_[field.offset + i] != 0; ++i) {
      const auto c = static_cast<char>(padded_[field.offset + i]);
      if (c >= ' ' && c <= '~') text += c;
    }
    return text;
  }

  /// What tells several of one kind apart: the number of a battery or a sensor, the name of a named value.
  [[nodiscard]] std::string part_of(const Frame& frame) const {
    for (const mavlink::DefinedField& field : frame.definition->fields) {
      const bool named = field.name == "name" && field.letter == 'c' && field.list;
      if (named) return words(field);
      const bool port = field.name == "port" && frame.definition->name == "SERVO_OUTPUT_RAW";
      const bool id = field.name == "id" &&
                      (frame.definition->name == "BATTERY_STATUS" || frame.definition->name == "DISTANCE_SENSOR");
      if ((port || id) && padded_[field.offset] != 0) return std::to_string(padded_[field.offset]);
    }
    return {};
  }

  Kind make(const Frame& frame, const std::string& part) {
    Topic topic{.name = std::string{frame.definition->name}, .type = std::string{frame.definition->name}};
    if (!part.empty()) topic.name += "[" + part + "]";
    if (std::pair{frame.system, frame.component} != vehicle_)
      topic.name += "@" + std::to_string(frame.system) + "." + std::to_string(frame.component);
    Kind kind{.topic = kinds_.size()};
    for (const mavlink::DefinedField& field : frame.definition->fields) {
      if (field.letter == 'c' && field.list) continue;
      if (field.name == "time_boot_ms" || field.name == "time_usec" || field.name == "usec") kind.time = &field;
      for (std::size_t i = 0; i < field.count; ++i)
        topic.fields.push_back({std::string{field.name} + (field.list ? "[" + std::to_string(i) + "]" : "")});
    }
    kind.rate = frame.id == kVisionDelta;
    for (int i = 0; kind.rate && i < 3; ++i) topic.fields.push_back({"velocity[" + std::to_string(i) + "]", "m/s"});
    kind.wanted = sink_.topic(kind.topic, topic);
    return kind;
  }

  void add_rate() {
    const double seconds = 1e-6 * values_[1];
    for (std::size_t i = 0; i < 3; ++i) values_.push_back(seconds > 0.0 ? values_[5 + i] / seconds : std::nan(""));
  }

  std::int64_t measured(Kind& kind) const {
    if (kind.time == nullptr) return kNoTime;
    const std::size_t at = kind.time->offset;
    std::uint64_t time = kind.time->letter == 'Q' ? little<std::uint64_t>(padded_, at)
                                                  : std::uint64_t{little<std::uint32_t>(padded_, at)};
    if (time == 0 || time > kLatestStamp) return kNoTime;
    if (kind.time->letter == 'I') {  // 32 bits of us begin again after 71 minutes
      constexpr std::uint64_t kRound = std::uint64_t{1} << 32U;
      if (time + kRound / 2 < kind.last) kind.wraps += kind.time->name == "time_usec" ? kRound : 0;
      kind.last = time;
      time += kind.wraps;
    }
    return static_cast<std::int64_t>(kind.time->name == "time_boot_ms" ? 1000 * time : time);
  }

  std::pair<int, int> vehicle_;
  Sink& sink_;
  std::map<std::tuple<std::uint32_t, int, int, std::string>, Kind> kinds_;
  std::array<std::uint8_t, 512> padded_{};
  std::vector<double> values_;
};

}  // namespace

bool is_tlog(Bytes head) {
  constexpr std::size_t kBegin = 2048;  // what is cut out of a log may begin within a frame
  for (std::size_t i = 0; i < std::min(head.size(), kBegin); ++i) {
    const std::optional<Frame> frame = frame_at(head.subspan(i));
    if (!frame) continue;
    if (frame->checked) return true;
    const std::optional<Frame> behind = frame_at(head.subspan(i + frame->length));
    if (behind && near(behind->stamp, frame->stamp)) return true;
  }
  return false;
}

void read(const std::string& path, Sink& sink, Damage& damage) {
  FileWindow file{path};
  Reader reader{vehicle_of(file), sink};
  Frames frames{file, damage};
  while (const std::optional<Frame> frame = frames.next()) reader.take(*frame);
}

}  // namespace fathom::recordings::tlog

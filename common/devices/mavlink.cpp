#include "common/devices/mavlink.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/devices/checksum.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/mavlink/definitions.hpp"

namespace fathom::devices {
namespace mavlink {
namespace {

constexpr std::array kMessages{
    Message{0, "HEARTBEAT", 50, "IBBBBB"},
    Message{1, "SYS_STATUS", 124, "IIIHHhHHHHHHb"},
    Message{27, "RAW_IMU", 144, "Qhhhhhhhhh"},
    Message{29, "SCALED_PRESSURE", 115, "Iffhh"},
    Message{30, "ATTITUDE", 39, "Iffffff"},
    Message{32, "LOCAL_POSITION_NED", 185, "Iffffff"},
    Message{36, "SERVO_OUTPUT_RAW", 222, "IHHHHHHHHB"},
    Message{65, "RC_CHANNELS", 118, "IHHHHHHHHHHHHHHHHHHBB"},
    Message{70, "RC_CHANNELS_OVERRIDE", 124, "HHHHHHHHBB"},
    Message{74, "VFR_HUD", 20, "ffffhH"},
    Message{76, "COMMAND_LONG", 152, "fffffffHBBB"},
    Message{77, "COMMAND_ACK", 143, "HB"},
    Message{116, "SCALED_IMU2", 76, "Ihhhhhhhhh"},
    Message{137, "SCALED_PRESSURE2", 195, "Iffhh"},
    Message{147, "BATTERY_STATUS", 154, "iihHHHHHHHHHHhBBBb"},
    Message{173, "RANGEFINDER", 83, "ff"},
    Message{178, "AHRS2", 47, "ffffii"},
    Message{253, "STATUSTEXT", 83, "B"},  // and fifty letters
};

void put(std::string& out, std::uint64_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) out += static_cast<char>(value >> 8 * i & 0xFFU);
}
void put(std::string& out, float value) { put(out, std::bit_cast<std::uint32_t>(value), 4); }

}  // namespace

std::span<const Message> messages() { return kMessages; }

const Message* message(std::uint32_t id) {
  for (const Message& each : kMessages) {
    if (each.id == id) return &each;
  }
  // The others are only to be told from damage: name and checksum, no fields.
  static const std::vector<Message> others = [] {
    std::vector<Message> all;
    for (const Definition& each : definitions()) all.push_back({each.id, each.name, each.crc_extra, ""});
    return all;
  }();
  const auto found = std::ranges::lower_bound(others, id, {}, &Message::id);
  return found == others.end() || found->id != id ? nullptr : &*found;
}

std::string Writer::packet(std::uint32_t id, std::string payload) {
  while (payload.size() > 1 && payload.back() == '\0') payload.pop_back();
  std::string body;
  put(body, payload.size(), 1);
  put(body, 0, 2);  // no signature, nothing to be compatible with
  put(body, sequence_++, 1);
  put(body, system_, 1);
  put(body, component_, 1);
  put(body, id, 3);
  body += payload;
  std::string checked = body;
  put(checked, message(id)->crc_extra, 1);
  put(body, crc16_reflected(as_bytes(checked), 0xFFFF), 2);
  return "\xFD" + body;
}

std::string Writer::heartbeat() {
  constexpr std::uint64_t kGroundStation = 6, kNoAutopilot = 8, kActive = 4, kVersion = 3;
  std::string payload;
  put(payload, 0, 4);
  put(payload, kGroundStation, 1);
  put(payload, kNoAutopilot, 1);
  put(payload, 0, 1);
  put(payload, kActive, 1);
  put(payload, kVersion, 1);
  return packet(0, payload);
}

std::string Writer::rc_override(const std::array<std::uint16_t, 8>& channels, std::uint8_t target) {
  std::string payload;
  for (const std::uint16_t each : channels) put(payload, each, 2);
  put(payload, target, 1);
  put(payload, 1, 1);
  return packet(70, payload);
}

std::string Writer::motor_test(std::size_t motor, double pwm, double seconds, std::uint8_t target) {
  constexpr std::uint64_t kDoMotorTest = 209;
  constexpr float kPwm = 1.0F;         // kind of throttle
  constexpr float kBoardOrder = 2.0F;  // the only one that ArduSub takes
  std::string payload;
  for (const float each : {static_cast<float>(motor), kPwm, static_cast<float>(std::round(pwm)),
                           static_cast<float>(seconds), 1.0F, kBoardOrder, 0.0F}) {
    put(payload, each);
  }
  put(payload, kDoMotorTest, 2);
  put(payload, target, 1);
  put(payload, 1, 1);
  put(payload, 0, 1);
  return packet(76, payload);
}

std::string Writer::command_ack(std::uint16_t command, std::uint8_t result) {
  std::string payload;
  put(payload, command, 2);
  put(payload, result, 1);
  return packet(77, payload);
}

}  // namespace mavlink

namespace {

constexpr std::uint8_t kMagic1 = 0xFE, kMagic2 = 0xFD;
constexpr std::size_t kSignature = 13;
constexpr std::size_t kLongest = 8 + 10 + 255 + 2 + kSignature;  // with the stamp of a telemetry log
constexpr std::uint32_t kSysStatus = 1, kServoOutput = 36, kBatteryStatus = 147;
constexpr double kExact = 9e15;      // whole numbers below are whole in a double
constexpr double kNoCell = 65535.0;  // mV: there is no such cell

// In a telemetry log each frame stands behind the time of its receipt: eight bytes, the greatest first, us since 1970.
constexpr std::size_t kStamp = 8;
constexpr std::uint64_t kEarliestStamp = 946'684'800'000'000, kLatestStamp = 4'102'444'800'000'000;  // 2000, 2100

std::uint64_t stamp_of(Bytes bytes) {
  std::uint64_t stamp = 0;
  for (std::size_t i = 0; i < kStamp; ++i) stamp = stamp << 8U | bytes[i];
  return stamp;
}

bool is_stamp(std::uint64_t stamp) { return stamp >= kEarliestStamp && stamp <= kLatestStamp; }

}  // namespace

Mavlink::Mavlink(const Settings& settings) : Parser{kLongest}, motors_{settings.motors} {
  thrusters_.pwm_us.resize(motors_);
}

Mavlink::Header Mavlink::header(Bytes bytes) {
  if (bytes[0] == kMagic1) return {.size = 6, .payload = bytes[1], .trailer = 2, .id = bytes[5]};
  return {
      .size = 10, .payload = bytes[1], .trailer = 2 + ((bytes[2] & 1) != 0 ? kSignature : 0), .id = little24(bytes, 7)};
}

Parser::Look Mavlink::look(Bytes bytes) const {
  if (bytes[0] == 0 && (bytes.size() < 2 || (bytes[1] >= 3 && bytes[1] <= 14))) {
    if (bytes.size() < kStamp + 1) return kMore;
    const std::uint8_t magic = bytes[kStamp];
    if (is_stamp(stamp_of(bytes)) && (magic == kMagic1 || magic == kMagic2)) {
      const Look frame = look(bytes.subspan(kStamp));
      if (frame.verdict == Look::Verdict::kFrame) return whole_frame(kStamp + frame.length);
      return frame.verdict == Look::Verdict::kMore ? kMore : skip(1);  // what is wrong with it is counted at its magic
    }
  }
  if (bytes[0] != kMagic1 && bytes[0] != kMagic2) {
    const auto found = std::find_if(bytes.begin(), bytes.end(), [](auto b) { return b == kMagic1 || b == kMagic2; });
    // What stands before a magic may be a stamp.
    const auto zero = std::find(bytes.begin() + 1, found, std::uint8_t{0});
    if (zero != found) return skip(static_cast<std::size_t>(zero - bytes.begin()));
    return skip(static_cast<std::size_t>(found - bytes.begin()));
  }
  if (bytes.size() < (bytes[0] == kMagic1 ? 6U : 10U)) return kMore;
  const Header head = header(bytes);
  const mavlink::Message* known = mavlink::message(head.id);
  if (known == nullptr || (bytes[0] == kMagic2 && bytes[2] > 1)) return skip(1);
  if (bytes.size() < head.size + head.payload + head.trailer) return kMore;
  const std::uint16_t crc = crc16_reflected(bytes.subspan(1, head.size - 1 + head.payload), 0xFFFF);
  const std::uint8_t extra[]{known->crc_extra};
  const auto stated = little<std::uint16_t>(bytes, head.size + head.payload);
  if (!checksum_right(stated, crc16_reflected(extra, crc))) return kBadChecksum;
  return whole_frame(head.size + head.payload + head.trailer);
}

int Mavlink::system() const { return bytes_[0] == kMagic1 ? bytes_[3] : bytes_[5]; }
int Mavlink::component() const { return bytes_[0] == kMagic1 ? bytes_[4] : bytes_[6]; }

double Mavlink::value(std::size_t field) const {
  std::size_t at = 0;
  for (std::size_t i = 0; i < field; ++i) at += mavlink::size_of(message_->fields[i]);
  const Bytes b{payload_};
  switch (message_->fields[field]) {
    case 'Q':
      return static_cast<double>(little<std::uint64_t>(b, at));
    case 'I':
      return little<std::uint32_t>(b, at);
    case 'i':
      return little<std::int32_t>(b, at);
    case 'H':
      return little<std::uint16_t>(b, at);
    case 'h':
      return little<std::int16_t>(b, at);
    case 'f':
      return little<float>(b, at);
    case 'b':
      return static_cast<std::int8_t>(b[at]);
    default:
      return b[at];
  }
}

std::string Mavlink::text() const {
  constexpr std::size_t kMostText = 50;
  std::string text;
  for (std::size_t i = 1; i <= kMostText && payload_[i] != 0; ++i) {
    if (payload_[i] >= ' ' && payload_[i] <= '~') text += static_cast<char>(payload_[i]);
  }
  return text;
}

void Mavlink::take(Frame& frame) {
  bytes_ = frame.bytes;
  const bool stamped = bytes_[0] != kMagic1 && bytes_[0] != kMagic2;
  if (stamped) {
    frame.device_time = 1e-6 * static_cast<double>(stamp_of(bytes_));
    bytes_ = bytes_.subspan(kStamp);
  }
  const Header head = header(bytes_);
  id_ = head.id;
  message_ = mavlink::message(id_);
  payload_ = {};
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(head.size), head.payload, payload_.begin());
  double millivolts = 0.0;
  if (id_ == kSysStatus && value(4) < kNoCell) millivolts = value(4);
  if (id_ == kBatteryStatus) {
    for (std::size_t cell = 3; cell < 13; ++cell) millivolts += value(cell) < kNoCell ? value(cell) : 0.0;
  }
  if (millivolts > 0.0) {
    battery_ = Battery{.voltage = 1e-3 * millivolts};
    frame.sample = &battery_;
  }
  if (id_ == kServoOutput) {
    // Servos beyond the eighth are an extension behind the port.
    const Bytes wire{payload_};
    for (std::size_t i = 0; i < motors_; ++i) {
      thrusters_.pwm_us[i] = i < 8 ? value(1 + i) : little<std::uint16_t>(wire, 21 + 2 * (i - 8));
    }
    if (!stamped) frame.device_time = 1e-6 * value(0);
    const bool all =
        std::all_of(thrusters_.pwm_us.begin(), thrusters_.pwm_us.end(), [](double pwm) { return pwm > 0.0; });
    if (all) frame.sample = &thrusters_;  // zero: the output gives no pulse
  }
}

void Mavlink::describe(Fields& fields) const {
  fields.add("magic", bytes_[0]);
  fields.add("sysid", system());
  fields.add("compid", component());
  fields.add("msgid", id_);
  fields.add("name", message_->name);
  constexpr std::array kNames{"f1",  "f2",  "f3",  "f4",  "f5",  "f6",  "f7",  "f8",  "f9",  "f10", "f11",
                              "f12", "f13", "f14", "f15", "f16", "f17", "f18", "f19", "f20", "f21"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (i >= message_->fields.size()) {
      fields.add(kNames[i], "");
    } else if (message_->fields[i] == 'f') {
      fields.add(kNames[i], static_cast<float>(value(i)));
    } else if (value(i) > kExact) {
      fields.add(kNames[i], value(i));
    } else {
      fields.add(kNames[i], static_cast<std::int64_t>(value(i)));
    }
  }
}

}  // namespace fathom::devices

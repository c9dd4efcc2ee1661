#include "common/devices/acoustics/seatrac.hpp"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <type_traits>

#include "common/base/spatial.hpp"
#include "common/devices/checksum.hpp"
#include "common/devices/text.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kLongest = 1 + 2 * 320 + 1;
constexpr std::size_t kLeast = 3;  // bytes: identifier and checksum
constexpr std::uint8_t kPing = 0x42, kEcho = 0x4A, kNavigation = 0x52, kDatagram = 0x61;
constexpr unsigned kRange = 1, kAngles = 2, kPosition = 4, kEnhanced = 8, kDoubted = 16;  // flags of a fix
constexpr double kDecimetre = 0.1;                                                        // m

// Beacons send capital digits; a small one is damage.
bool is_hexadecimal(char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'F'); }

std::size_t decode(std::string_view digits, std::span<std::uint8_t> into) {
  const std::size_t size = digits.size() / 2;
  for (std::size_t i = 0; i < size; ++i) into[i] = hex_byte(digits.substr(2 * i, 2)).value_or(0);
  return size;
}

std::string_view digits_of(std::string_view line) { return line.substr(1, line.find_first_of("\r\n") - 1); }

}  // namespace

Seatrac::Seatrac(const Settings& settings)
    : Parser{kLongest}, from_{settings.transceiver}, wanted_{settings.transceiver.beacon} {}

Parser::Look Seatrac::look(Bytes bytes) const {
  if (bytes[0] != '$') return skip_to(bytes, '$');
  const std::string_view text = as_text(bytes.first(std::min(bytes.size(), kLongest)));
  const auto end = std::find_if_not(text.begin() + 1, text.end(), is_hexadecimal);
  if (end == text.end()) return text.size() < kLongest ? kMore : kBadFrame;
  if (*end != '\r' && *end != '\n') return kBadFrame;
  const std::string_view digits = digits_of(text);
  if (digits.size() % 2 != 0 || digits.size() < 2 * kLeast) return kBadFrame;
  std::array<std::uint8_t, kMostBytes> raw;
  const Bytes message{raw.data(), decode(digits, raw)};
  const std::size_t size = message.size() - 2;
  if (!checksum_right(little<std::uint16_t>(message, size), crc16_arc(message.first(size)))) return kBadChecksum;
  return whole_frame(digits.size() + 2);
}

// Destination, source, flags, kind; tilts of the head, its depth, sound speed, level; then what the flags announce.
std::optional<Seatrac::Fix> Seatrac::read_fix(Bytes bytes) {
  constexpr std::size_t kAlways = 16, kRangeSize = 10, kPositionSize = 6;
  if (bytes.size() < kAlways) return {};
  Fix fix{.source = bytes[1],
          .flags = bytes[2],
          .yaw = little<std::int16_t>(bytes, 4),
          .pitch = little<std::int16_t>(bytes, 6),
          .roll = little<std::int16_t>(bytes, 8),
          .rssi = little<std::int16_t>(bytes, 14),
          .depth = little<std::uint16_t>(bytes, 10),
          .sound_speed = little<std::uint16_t>(bytes, 12)};
  std::size_t at = kAlways;
  if ((fix.flags & kRange) != 0) {
    if (bytes.size() < at + kRangeSize) return {};
    fix.distance = little<std::uint16_t>(bytes, at + 8);
    at += kRangeSize;
  }
  if ((fix.flags & kAngles) != 0) {
    if (bytes.size() < at + 1) return {};
    const std::size_t levels = 1 + 2 * std::size_t{bytes[at]};
    if (bytes.size() < at + levels + 6) return {};
    fix.azimuth = little<std::int16_t>(bytes, at + levels);
    fix.elevation = little<std::int16_t>(bytes, at + levels + 2);
    fix.fit_error = little<std::int16_t>(bytes, at + levels + 4);
    at += levels + 6;
  }
  if ((fix.flags & kPosition) != 0) {
    if (bytes.size() < at + kPositionSize) return {};
    fix.easting = little<std::int16_t>(bytes, at);
    fix.northing = little<std::int16_t>(bytes, at + 2);
    fix.down = little<std::int16_t>(bytes, at + 4);
  }
  return fix;
}

void Seatrac::take(Frame& frame) {
  size_ = decode(digits_of(as_text(frame.bytes)), message_) - 2;
  fix_.reset();
  const std::uint8_t id = message_[0];
  if (id != kPing && id != kEcho && id != kNavigation && id != kDatagram) return;
  fix_ = read_fix({message_.data() + 1, size_ - 1});
  if (!fix_) {
    frame.lacks = "a fix that is shorter than its flags announce";
    return;
  }
  if (!fix_->northing) {
    frame.lacks = "the fix holds no position (no bearing: is it asked for, and is the head an X150?)";
    return;
  }
  std::array<char, 3> name{};
  const auto source = static_cast<std::size_t>(std::snprintf(name.data(), name.size(), "%u", fix_->source % 100U));
  if (!wanted_.is({name.data(), std::min(source, name.size() - 1)})) {
    frame.lacks = "a fix of another beacon";
    return complain(wanted_.complaint());
  }
  complain("");
  const Eigen::Vector3d magnetic{kDecimetre * *fix_->northing, kDecimetre * *fix_->easting, kDecimetre * *fix_->down};
  const Eigen::Vector3d p = rotation_from_euler({0.0, 0.0, from_.declination}) * magnetic;
  sample_ = Usbl{.p_WB = from_north_up(p.x(), p.y(), p.z(), from_),
                 .sigma = Eigen::Vector3d::Constant(from_.sigma),
                 .valid = (fix_->flags & kDoubted) == 0};
  // An enhanced fix holds what the beacon's own depth sensor says; the others, how far below the head it is.
  if ((fix_->flags & kEnhanced) != 0) sample_.p_WB.z() = p.z();
  frame.sample = &sample_;
}

void Seatrac::describe(Fields& fields) const {
  fields.add_hex("message", message_[0], 2);
  fields.add("length", size_);
  const auto tenth = [&](const char* name, const auto& value) {
    if (value) {
      fields.add_fixed(name, 0.1 * *value, 1);
    } else {
      fields.add(name, "");
    }
  };
  const auto of = [&](auto member) {
    using Value = std::decay_t<decltype((*fix_).*member)>;
    return fix_ ? std::optional<Value>{(*fix_).*member} : std::nullopt;
  };
  const auto within = [&](auto member) { return fix_ ? (*fix_).*member : std::nullopt; };
  fields.add("beacon", of(&Fix::source));
  if (fix_) {
    fields.add_hex("flags", fix_->flags, 2);
  } else {
    fields.add("flags", "");
  }
  tenth("head_yaw_deg", of(&Fix::yaw));
  tenth("head_pitch_deg", of(&Fix::pitch));
  tenth("head_roll_deg", of(&Fix::roll));
  tenth("head_depth_m", of(&Fix::depth));
  tenth("sos_mps", of(&Fix::sound_speed));
  tenth("rssi_db", of(&Fix::rssi));
  tenth("distance_m", fix_ ? fix_->distance : std::nullopt);
  tenth("azimuth_deg", within(&Fix::azimuth));
  tenth("elevation_deg", within(&Fix::elevation));
  tenth("easting_m", within(&Fix::easting));
  tenth("northing_m", within(&Fix::northing));
  tenth("depth_m", within(&Fix::down));
}

}  // namespace fathom::devices

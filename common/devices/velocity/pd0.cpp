#include "common/devices/velocity/pd0.hpp"

#include <algorithm>
#include <cmath>

#include "common/devices/attitude.hpp"
#include "common/devices/checksum.hpp"
#include "common/devices/text.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kMostBytes = 8192;
constexpr std::size_t kFewestBytes = 8;   // header with one data type
constexpr std::size_t kLeader = 46;       // of the fixed and the variable leader: the shortest seen
constexpr std::size_t kBottom = 32;       // up to the velocities
constexpr std::uint16_t kDegree = 18000;  // a heading beyond 360 degrees or a tilt beyond 180 is none

std::optional<double> millimetres(std::int16_t value) {
  if (value == Pd0::kBad) return {};
  return 1e-3 * value;
}

}  // namespace

Pd0::Pd0(const Settings& settings)
    : Parser{kMostBytes + 2}, R_BS_{settings.R_BS}, stated_beam_angle_{settings.beam_angle} {}

Parser::Look Pd0::look(Bytes bytes) const {
  if (bytes[0] != 0x7F) return skip_to(bytes, 0x7F);
  if (bytes.size() < 6) return bytes.size() > 1 && bytes[1] != 0x7F ? skip(1) : kMore;
  if (bytes[1] != 0x7F) return skip(1);
  const std::size_t size = little<std::uint16_t>(bytes, 2);
  if (size > kMostBytes) complain("a frame claims more bytes than PD0 has; is it PD0, and is the baud rate right?");
  if (size < kFewestBytes || size > kMostBytes || 6 + 2 * std::size_t{bytes[5]} > size) return kBadFrame;
  if (bytes.size() < size + 2) return kMore;
  if (!checksum_right(little<std::uint16_t>(bytes, size), sum16(bytes.first(size)))) return kBadChecksum;
  return whole_frame(size + 2);
}

// A block reaches to the next larger offset.
void Pd0::find_blocks() {
  fixed_ = variable_ = velocity_ = correlation_ = echo_ = good_ = bottom_ = fine_bottom_ = fine_range_ = {};
  const std::size_t size = bytes_.size() - 2;
  const std::size_t count = bytes_[5];
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = little<std::uint16_t>(bytes_, 6 + 2 * i);
    if (at + 2 > size) continue;
    std::size_t end = size;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t other = little<std::uint16_t>(bytes_, 6 + 2 * k);
      if (other > at && other < end) end = other;
    }
    const Bytes block = bytes_.subspan(at, end - at);
    if (block.size() < 2) continue;
    switch (little<std::uint16_t>(block, 0)) {
      case 0x0000:
        if (block.size() >= kLeader) fixed_ = block;
        break;
      case 0x0080:
        if (block.size() >= kLeader) variable_ = block;
        break;
      case 0x0100:
        velocity_ = block.subspan(2);
        break;
      case 0x0200:
        correlation_ = block.subspan(2);
        break;
      case 0x0300:
        echo_ = block.subspan(2);
        break;
      case 0x0400:
        good_ = block.subspan(2);
        break;
      case 0x0600:
        if (block.size() >= kBottom) bottom_ = block;
        break;
      case 0x5803:
        if (block.size() >= 70) fine_bottom_ = block;
        break;
      case 0x5804:
        if (block.size() >= 41) fine_range_ = block;
        break;
      default:
        break;
    }
  }
}

void Pd0::take(Frame& frame) {
  offset_ = frame.offset;
  bytes_ = frame.bytes;
  find_blocks();
  frame.device_time = clock();
  if (fixed_.empty() || bottom_.empty()) {
    frame.lacks = "an ensemble without bottom track; is it switched on (BP)?";
    return;
  }
  read_pose();
  sample_ = Dvl{.valid = false};
  sample_.valid = read_velocity();
  std::array<std::optional<double>, 4> ranges;
  for (std::size_t i = 0; i < 4; ++i) {
    const unsigned high = bottom_.size() >= 81 ? bottom_[77 + i] : 0U;
    const unsigned range = little<std::uint16_t>(bottom_, 16 + 2 * i) + (high << 16);
    if (range > 0) ranges[i] = 1e-2 * range;
  }
  sample_.altitude = altitude(ranges, janus_, pose_).value_or(0.0);
  frame.sample = &sample_;
}

// The flag "up" is of the profile. A vehicle with two heads toggles it with every ensemble, while its bottom track goes
// on smoothly, with ranges that grow and shrink with pitch as those of a head that looks down.
bool Pd0::read_velocity() {
  std::array<std::optional<double>, 4> said;
  for (std::size_t i = 0; i < 4; ++i) said[i] = millimetres(little<std::int16_t>(bottom_, 24 + 2 * i));
  std::optional<Eigen::Vector3d> bottom;
  if (pose_.frame == DvlFrame::kBeam) {
    bottom = from_beams(said, janus_);
    if (janus_.beam_angle == 0.0) complain("the instrument does not say its beam angle; state 'beam_angle'");
  } else if (said[0] && said[1] && said[2]) {
    bottom = Eigen::Vector3d{*said[0], *said[1], *said[2]};
  }
  if (!bottom) return false;
  const auto v = to_body(-*bottom, pose_);
  if (!v) return false;
  sample_.v_WB_B = *v;
  return true;
}

void Pd0::read_pose() {
  const auto system = little<std::uint16_t>(fixed_, 4);
  constexpr std::array kAngles{15.0, 20.0, 30.0, 0.0};
  janus_ = {.beam_angle = kAngles[system >> 8 & 3U] * kRadians, .convex = (system & 8U) != 0};
  if (janus_.beam_angle == 0.0) janus_.beam_angle = stated_beam_angle_.value_or(0.0);
  const std::uint8_t coordinates = fixed_[25];
  pose_ = {.frame = static_cast<DvlFrame>(coordinates >> 3 & 3U),
           .level = (coordinates & 4U) != 0,
           .alignment = 0.01 * kRadians * little<std::int16_t>(fixed_, 26),
           .R_BS = R_BS_};
  if (variable_.empty()) return;
  const auto heading = little<std::uint16_t>(variable_, 18);
  const auto pitch = little<std::int16_t>(variable_, 20);
  const auto roll = little<std::int16_t>(variable_, 22);
  if (heading > 2 * kDegree || std::abs(pitch) > kDegree || std::abs(roll) > kDegree) return;
  pose_.heading = 0.01 * kRadians * heading;
  pose_.roll = 0.01 * kRadians * roll;
  // Tilts of pendulums are each measured against the vertical; turned into the pitch of the Euler angles.
  pose_.pitch = std::atan(std::tan(0.01 * kRadians * pitch) * std::cos(*pose_.roll));
}

std::optional<double> Pd0::clock() const {
  if (variable_.empty()) return {};
  return seconds_since_1970(2000 + variable_[4], variable_[5], variable_[6], variable_[7], variable_[8],
                            variable_[9] + 0.01 * variable_[10]);
}

std::size_t Pd0::cells() const {
  if (fixed_.empty()) return 0;
  return std::min<std::size_t>(fixed_[9], velocity_.size() / 8);
}
std::int16_t Pd0::velocity(std::size_t cell, std::size_t beam) const {
  return little<std::int16_t>(velocity_, 8 * cell + 2 * beam);
}
std::uint8_t Pd0::correlation(std::size_t cell, std::size_t beam) const { return correlation_[4 * cell + beam]; }
std::uint8_t Pd0::echo(std::size_t cell, std::size_t beam) const { return echo_[4 * cell + beam]; }

}  // namespace fathom::devices

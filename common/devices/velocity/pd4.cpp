#include "common/devices/velocity/pd4.hpp"

#include <array>

#include "common/devices/attitude.hpp"
#include "common/devices/checksum.hpp"
#include "common/devices/text.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kPd4 = 47, kPd5 = 88;  // bytes with the checksum
constexpr std::int16_t kBad = -32768;
constexpr double kUsualBeamAngle = 30.0 * kRadians;  // of every log that speaks PD4

std::optional<std::int16_t> velocity(Bytes bytes, std::size_t at) {
  const auto value = little<std::int16_t>(bytes, at);
  return value == kBad ? std::nullopt : std::optional{value};
}

DvlFrame frame_of(Bytes bytes) { return static_cast<DvlFrame>(bytes[4] >> 6); }

}  // namespace

Pd4::Pd4(const Settings& settings) : Parser{kPd5}, settings_{settings} {}

Parser::Look Pd4::look(Bytes bytes) const {
  if (bytes[0] != 0x7D) return skip_to(bytes, 0x7D);
  if (bytes.size() < 4) return bytes.size() > 1 && bytes[1] > 1 ? skip(1) : kMore;
  if (bytes[1] > 1) return skip(1);
  const std::size_t size = bytes[1] == 0 ? kPd4 : kPd5;
  const std::size_t stated = little<std::uint16_t>(bytes, 2);
  if (stated != size && stated != size - 2) return kBadFrame;
  if (bytes.size() < size) return kMore;
  if (!checksum_right(little<std::uint16_t>(bytes, size - 2), sum16(bytes.first(size - 2)))) return kBadChecksum;
  return whole_frame(size);
}

void Pd4::take(Frame& frame) {
  bytes_ = frame.bytes;
  const Bytes b = bytes_;
  if (b[35] < 24 && b[36] < 60 && b[37] < 60 && b[38] < 100) {
    frame.device_time = 3600.0 * b[35] + 60.0 * b[36] + b[37] + 0.01 * b[38];
  }
  DvlPose pose{.frame = frame_of(b), .level = settings_.ship_is_level || (b[4] >> 5 & 1) != 0, .R_BS = settings_.R_BS};
  if (is_pd5()) {
    pose.pitch = 0.01 * kRadians * little<std::int16_t>(b, 48);
    pose.roll = 0.01 * kRadians * little<std::int16_t>(b, 50);
    pose.heading = 0.01 * kRadians * little<std::uint16_t>(b, 52);
  } else if (settings_.water_linked_axes) {
    pose.level = false;  // it has no tilts to take out
  }
  const Janus janus{.beam_angle = settings_.beam_angle.value_or(kUsualBeamAngle)};
  std::array<std::optional<double>, 4> said;
  std::array<std::optional<double>, 4> ranges;
  for (std::size_t i = 0; i < 4; ++i) {
    if (const auto value = velocity(b, 5 + 2 * i)) said[i] = 1e-3 * *value;
    if (const auto range = little<std::uint16_t>(b, 13 + 2 * i); range > 0) ranges[i] = 1e-2 * range;
  }
  sample_ = Dvl{.altitude = altitude(ranges, janus, pose).value_or(0.0), .valid = false};
  frame.sample = &sample_;
  std::optional<Eigen::Vector3d> v;
  if (pose.frame == DvlFrame::kBeam) {
    v = from_beams(said, janus);
  } else if (said[0] && said[1] && said[2]) {
    v = Eigen::Vector3d{*said[0], *said[1], *said[2]};
  }
  if (!v || b[21] != 0) return;
  const auto v_B = settings_.water_linked_axes && pose.frame != DvlFrame::kEarth
                       ? std::optional{Eigen::Vector3d{settings_.R_BS * Eigen::Vector3d{v->y(), v->x(), v->z()}}}
                       : to_body(*v, pose);
  if (!v_B) {
    complain("PD4 says no attitude, so velocities without tilts cannot be turned to the body: choose PD5 or EX..0..");
    return;
  }
  sample_.v_WB_B = *v_B;
  sample_.valid = true;
}

void Pd4::describe(Fields& fields) const {
  const Bytes b = bytes_;
  fields.add("structure", is_pd5() ? "PD5" : "PD4");
  fields.add("length", little<std::uint16_t>(b, 2));
  fields.add_hex("system", b[4], 2);
  fields.add("frame", name(frame_of(b)));
  const auto four = [&](const std::array<const char*, 4>& names, auto read) {
    for (std::size_t i = 0; i < 4; ++i) fields.add(names[i], read(i));
  };
  four({"vel1_mmps", "vel2_mmps", "vel3_mmps", "vel4_mmps"}, [&](std::size_t i) { return velocity(b, 5 + 2 * i); });
  four({"range1_cm", "range2_cm", "range3_cm", "range4_cm"},
       [&](std::size_t i) { return little<std::uint16_t>(b, 13 + 2 * i); });
  fields.add("bottom_status", b[21]);
  four({"water1_mmps", "water2_mmps", "water3_mmps", "water4_mmps"},
       [&](std::size_t i) { return velocity(b, 22 + 2 * i); });
  fields.add("layer_start_dm", little<std::uint16_t>(b, 30));
  fields.add("layer_end_dm", little<std::uint16_t>(b, 32));
  fields.add("layer_status", b[34]);
  fields.add_fixed("time_s", 3600.0 * b[35] + 60.0 * b[36] + b[37] + 0.01 * b[38], 2);
  fields.add("bit", little<std::uint16_t>(b, 39));
  fields.add("sos_mps", little<std::uint16_t>(b, 41));
  fields.add_fixed("temp_c", 0.01 * little<std::int16_t>(b, 43), 2);
  if (!is_pd5()) {
    for (const char* name : {"salinity_ppt", "depth_dm", "pitch_deg", "roll_deg", "heading_deg"}) fields.add(name, "");
    return;
  }
  fields.add("salinity_ppt", b[45]);
  fields.add("depth_dm", little<std::uint16_t>(b, 46));
  fields.add_fixed("pitch_deg", 0.01 * little<std::int16_t>(b, 48), 2);
  fields.add_fixed("roll_deg", 0.01 * little<std::int16_t>(b, 50), 2);
  fields.add_fixed("heading_deg", 0.01 * little<std::uint16_t>(b, 52), 2);
}

}  // namespace fathom::devices

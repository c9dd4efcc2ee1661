#include "common/devices/inertial/vectornav.hpp"

#include <bit>

#include "common/devices/attitude.hpp"
#include "common/devices/checksum.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kLongest = 1024;
constexpr std::size_t kGroups = 5;
constexpr std::uint8_t kRefused = 0b11101000;  // GPS, INS, and groups that do not exist
constexpr std::size_t kCommon = 0, kTime = 1, kImu = 2, kAttitude = 4;

// Bytes of each field (manual, table 18); 0: reserved.
constexpr std::array<std::array<std::uint8_t, 16>, kGroups> kSizes{{
    {8, 8, 8, 12, 16, 12, 24, 12, 12, 24, 20, 28, 2, 4, 8, 0},
    {8, 8, 8, 2, 8, 8, 8, 4, 4, 1, 0, 0, 0, 0, 0, 0},
    {2, 12, 12, 12, 4, 4, 16, 12, 12, 12, 12, 2, 0, 0, 0, 0},
    {},
    {2, 12, 16, 36, 12, 12, 12, 12, 12, 28, 24, 0, 0, 0, 0, 0},
}};

Eigen::Vector3d vector(Bytes bytes, std::size_t at) {
  return {little<float>(bytes, at), little<float>(bytes, at + 4), little<float>(bytes, at + 8)};
}

}  // namespace

VectorNav::VectorNav(const Settings& settings) : Parser{kLongest}, R_BS_{settings.R_BS} {}

Parser::Look VectorNav::look(Bytes bytes) const {
  if (bytes[0] != 0xFA) return skip_to(bytes, 0xFA);
  if (bytes.size() < 2) return kMore;
  const std::uint8_t groups = bytes[1];
  if (groups == 0 || (groups & kRefused) != 0) return skip(1);
  const std::size_t header = 2 + 2 * static_cast<std::size_t>(std::popcount(groups));
  if (bytes.size() < header) return kMore;
  std::size_t size = header;
  std::size_t at = 2;
  for (std::size_t group = 0; group < kGroups; ++group) {
    if ((groups >> group & 1U) == 0) continue;
    const auto mask = little<std::uint16_t>(bytes, at);
    at += 2;
    for (std::size_t field = 0; field < 16; ++field) {
      if ((mask >> field & 1U) == 0) continue;
      if (kSizes[group][field] == 0) return kBadFrame;
      size += kSizes[group][field];
    }
  }
  if (bytes.size() < size + 2) return kMore;
  return checksum_right(0, crc16_xmodem(bytes.subspan(1, size + 1))) ? whole_frame(size + 2) : kBadChecksum;
}

void VectorNav::take(Frame& frame) {
  bytes_ = frame.bytes;
  groups_ = bytes_[1];
  at_ = {};
  std::size_t mask_at = 2;
  std::size_t at = 2 + 2 * static_cast<std::size_t>(std::popcount(groups_));
  for (std::size_t group = 0; group < kGroups; ++group) {
    if ((groups_ >> group & 1U) == 0) continue;
    const auto mask = little<std::uint16_t>(bytes_, mask_at);
    mask_at += 2;
    for (std::size_t field = 0; field < 16; ++field) {
      if ((mask >> field & 1U) == 0) continue;
      at_[group][field] = static_cast<std::uint16_t>(at);
      at += kSizes[group][field];
    }
  }

  sample_ = {};
  const auto first = [&](std::initializer_list<std::size_t> places) {
    for (const std::size_t place : places) {
      if (place != 0) return place;
    }
    return std::size_t{0};
  };
  // Compensated before uncompensated.
  const std::size_t gyro = first({at_[kCommon][5], at_[kImu][10], at_[kImu][3]});
  const std::size_t accel = first({at_[kCommon][8], at_[kImu][9], at_[kImu][2]});
  const std::size_t quaternion = first({at_[kAttitude][2], at_[kCommon][4]});
  const std::size_t euler = first({at_[kAttitude][1], at_[kCommon][3]});
  if (gyro != 0) sample_.w_WB_B = vector(bytes_, gyro);
  if (accel != 0) sample_.f_B = vector(bytes_, accel);
  sample_.has_rates = gyro != 0;
  sample_.has_specific_force = accel != 0;
  if (quaternion != 0) {  // scalar last
    const Eigen::Quaterniond q{little<float>(bytes_, quaternion + 12), little<float>(bytes_, quaternion),
                               little<float>(bytes_, quaternion + 4), little<float>(bytes_, quaternion + 8)};
    sample_.q_WB = q.normalized() * Eigen::Quaterniond{R_BS_.transpose()};
    sample_.has_attitude = q.norm() > 0.5;
  } else if (euler != 0) {  // yaw, pitch, roll in degrees
    sample_.q_WB = body_attitude(vector(bytes_, euler).reverse() * kRadians, R_BS_);
    sample_.has_attitude = true;
  }
  const std::size_t startup = first({at_[kCommon][0], at_[kTime][0]});
  if (startup != 0) frame.device_time = 1e-9 * static_cast<double>(little<std::uint64_t>(bytes_, startup));
  mount(sample_, R_BS_);
  const bool says = sample_.has_rates || sample_.has_specific_force || sample_.has_attitude;
  if (says && sample_.w_WB_B.allFinite() && sample_.f_B.allFinite() && sample_.q_WB.coeffs().allFinite()) {
    frame.sample = &sample_;
  } else {
    frame.lacks = says ? "a number is none" : "no attitude, rates or acceleration is chosen for output";
  }
}

void VectorNav::describe(Fields& fields) const {
  const auto real = [&](const char* name, std::size_t at) {
    fields.add(name, at != 0 ? std::optional{little<float>(bytes_, at)} : std::nullopt);
  };
  const auto reals = [&](std::initializer_list<const char*> names, std::size_t at) {
    for (const char* name : names) {
      real(name, at);
      if (at != 0) at += 4;
    }
  };
  fields.add_hex("groups", groups_, 2);
  const std::size_t startup = at_[kCommon][0] != 0 ? at_[kCommon][0] : at_[kTime][0];
  fields.add("time_startup_ns", startup != 0 ? std::optional{little<std::int64_t>(bytes_, startup)} : std::nullopt);
  const auto either = [](std::size_t a, std::size_t b) { return a != 0 ? a : b; };
  reals({"mag_x", "mag_y", "mag_z"}, either(at_[kImu][1], at_[kImu][8]));
  reals({"acc_x", "acc_y", "acc_z"}, either(at_[kCommon][8], either(at_[kImu][9], at_[kImu][2])));
  reals({"gyro_x", "gyro_y", "gyro_z"}, either(at_[kCommon][5], either(at_[kImu][10], at_[kImu][3])));
  real("temp_c", at_[kImu][4]);
  real("pres_kpa", at_[kImu][5]);
  reals({"yaw_deg", "pitch_deg", "roll_deg"}, either(at_[kAttitude][1], at_[kCommon][3]));
  reals({"qx", "qy", "qz", "qw"}, either(at_[kAttitude][2], at_[kCommon][4]));
  reals({"dcm0", "dcm1", "dcm2", "dcm3", "dcm4", "dcm5", "dcm6", "dcm7", "dcm8"}, at_[kAttitude][3]);
  reals({"magned0", "magned1", "magned2"}, at_[kAttitude][4]);
  reals({"accned0", "accned1", "accned2"}, at_[kAttitude][5]);
}

}  // namespace fathom::devices

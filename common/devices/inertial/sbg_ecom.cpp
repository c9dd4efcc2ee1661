#include "common/devices/inertial/sbg_ecom.hpp"

#include <algorithm>

#include "common/devices/attitude.hpp"
#include "common/devices/checksum.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kMostData = 4086;
constexpr std::size_t kAround = 9;  // sync, message, class, length, CRC, end
constexpr std::uint8_t kImu = 3, kEuler = 6, kQuaternion = 7;
constexpr std::size_t kImuSize = 58, kEulerSize = 32, kQuaternionSize = 36;
// Solution status, bit 4: attitude is valid (roll and pitch better than 0.5 deg).
constexpr std::size_t kAttitudeValid = 4;
constexpr int kSurely = 2;  // joined in a row: the next attitude will come too

Eigen::Vector3d vector(Bytes data, std::size_t at) {
  return {little<float>(data, at), little<float>(data, at + 4), little<float>(data, at + 8)};
}

}  // namespace

SbgEcom::SbgEcom(const Settings& settings) : Parser{kMostData + kAround}, R_BS_{settings.R_BS} {}

Parser::Look SbgEcom::look(Bytes bytes) const {
  if (bytes[0] != 0xFF) return skip_to(bytes, 0xFF);
  if (bytes.size() < 6) return bytes.size() > 1 && bytes[1] != 0x5A ? skip(1) : kMore;
  if (bytes[1] != 0x5A) return skip(1);
  const std::size_t size = little<std::uint16_t>(bytes, 4);
  if (size > kMostData) return kBadFrame;
  if (bytes.size() < size + kAround) return kMore;
  if (bytes[size + 8] != 0x33) return kBadFrame;
  if (!checksum_right(little<std::uint16_t>(bytes, size + 6), crc16_reflected(bytes.subspan(2, size + 4), 0)))
    return kBadChecksum;
  return whole_frame(size + kAround);
}

// Rates of a moment whose attitude follows are told with it, once the instrument is seen to send both each time.
void SbgEcom::take_imu() {
  sample_.f_B = vector(data_, 6);
  sample_.w_WB_B = vector(data_, 18);
  sample_.has_specific_force = sample_.has_rates = true;
  mount(sample_, R_BS_);
  if (alone_) joined_ = 0;
  imu_ = sample_;
  moment_ = little<std::uint32_t>(data_, 0);
  alone_ = true;
  if (joined_ >= kSurely) sample_ = {};
}

void SbgEcom::join_imu() {
  if (!alone_ || moment_ != little<std::uint32_t>(data_, 0)) return;
  sample_.f_B = imu_.f_B;
  sample_.w_WB_B = imu_.w_WB_B;
  sample_.has_specific_force = sample_.has_rates = true;
  alone_ = false;
  joined_ = std::min(joined_ + 1, kSurely);
}

void SbgEcom::take(Frame& frame) {
  message_ = frame.bytes[2];
  class_ = frame.bytes[3];
  data_ = frame.bytes.subspan(6, frame.bytes.size() - kAround);
  crc_ = little<std::uint16_t>(frame.bytes, frame.bytes.size() - 3);
  if (class_ != 0) return;
  sample_ = {};
  if (message_ == kEuler && data_.size() == kEulerSize) {
    sample_.q_WB = body_attitude(vector(data_, 4), R_BS_);
    sample_.has_attitude = (little<std::uint32_t>(data_, 28) >> kAttitudeValid & 1U) != 0;
    join_imu();
  } else if (message_ == kQuaternion && data_.size() == kQuaternionSize) {
    const Eigen::Quaterniond q{little<float>(data_, 4), little<float>(data_, 8), little<float>(data_, 12),
                               little<float>(data_, 16)};
    sample_.q_WB = q.normalized() * Eigen::Quaterniond{R_BS_.transpose()};
    sample_.has_attitude = (little<std::uint32_t>(data_, 32) >> kAttitudeValid & 1U) != 0 && q.norm() > 0.5;
    join_imu();
  } else if (message_ == kImu && data_.size() == kImuSize) {
    take_imu();
  } else {
    return;
  }
  frame.device_time = 1e-6 * little<std::uint32_t>(data_, 0);
  const bool says = sample_.has_attitude || sample_.has_rates;
  if (says && sample_.w_WB_B.allFinite() && sample_.f_B.allFinite() && sample_.q_WB.coeffs().allFinite()) {
    frame.sample = &sample_;
  } else {
    frame.lacks = says ? "a number is none" : "the instrument says that its attitude is not valid";
  }
}

void SbgEcom::describe(Fields& fields) const {
  fields.add("class", class_);
  fields.add("msg", message_);
  fields.add("len", data_.size());
  fields.add_hex("crc", crc_, 4);
  const bool euler = class_ == 0 && message_ == kEuler && data_.size() == kEulerSize;
  const bool quaternion = class_ == 0 && message_ == kQuaternion && data_.size() == kQuaternionSize;
  const bool imu = class_ == 0 && message_ == kImu && data_.size() == kImuSize;
  fields.add("name", euler ? "ekf_euler" : quaternion ? "ekf_quat" : imu ? "imu_data" : "");
  const bool known = euler || quaternion || imu;
  fields.add("t_us", known ? std::optional{little<std::uint32_t>(data_, 0)} : std::nullopt);
  const auto real = [&](const char* name, bool there, std::size_t at) {
    fields.add(name, there ? std::optional{little<float>(data_, at)} : std::nullopt);
  };
  std::size_t at = 0;
  for (const char* name : {"roll_rad", "pitch_rad", "yaw_rad", "roll_sd", "pitch_sd", "yaw_sd"}) {
    if (euler || at < 12) {
      real(name, euler, 4 + at);
    } else {
      real(name, quaternion, 8 + at);
    }
    at += 4;
  }
  at = 4;
  for (const char* name : {"q_w", "q_x", "q_y", "q_z"}) {
    real(name, quaternion, at);
    at += 4;
  }
  at = 6;
  for (const char* name :
       {"accel_x_mps2", "accel_y_mps2", "accel_z_mps2", "gyro_x_radps", "gyro_y_radps", "gyro_z_radps", "temp_c",
        "dv_x_mps2", "dv_y_mps2", "dv_z_mps2", "da_x_radps", "da_y_radps", "da_z_radps"}) {
    real(name, imu, at);
    at += 4;
  }
  std::optional<std::uint32_t> status;
  if (euler) status = little<std::uint32_t>(data_, 28);
  if (quaternion) status = little<std::uint32_t>(data_, 32);
  if (imu) status = little<std::uint16_t>(data_, 4);
  fields.add("status", status);
}

}  // namespace fathom::devices

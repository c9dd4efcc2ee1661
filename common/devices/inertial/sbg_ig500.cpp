#include "common/devices/inertial/sbg_ig500.hpp"

#include <algorithm>

#include "common/devices/attitude.hpp"
#include "common/devices/checksum.hpp"

namespace fathom::devices {
namespace ig500 {
namespace {

constexpr std::array<std::uint8_t, kOutputs> kSizes{16, 12, 36, 12, 12, 12, 8, 6,  6, 6,  4,  4, 4, 12, 16, 16,
                                                    6,  4,  4,  24, 12, 4,  8, 12, 6, 10, 12, 8, 8, 12, 4};

}  // namespace

std::size_t output_size(std::size_t bit) { return bit < kOutputs ? kSizes[bit] : 0; }

std::size_t buffer_size(std::uint32_t mask) {
  std::size_t size = 0;
  for (std::size_t bit = 0; bit < kOutputs; ++bit) {
    if ((mask >> bit & 1U) != 0) size += kSizes[bit];
  }
  return size;
}

std::vector<std::uint8_t> frame(std::uint8_t command, Bytes data) {
  const auto size = static_cast<std::uint16_t>(data.size());
  std::vector<std::uint8_t> bytes;
  bytes.reserve(data.size() + 8);
  const std::uint8_t header[]{0xFF, 0x02, command, static_cast<std::uint8_t>(size >> 8),
                              static_cast<std::uint8_t>(size & 0xFFU)};
  for (const std::uint8_t byte : header) bytes.push_back(byte);
  for (const std::uint8_t byte : data) bytes.push_back(byte);
  const std::uint16_t crc = crc16_reflected(Bytes{bytes}.subspan(2), 0);
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8));
  bytes.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  bytes.push_back(0x03);
  return bytes;
}

}  // namespace ig500

namespace {

constexpr std::size_t kMostData = 504;
constexpr std::size_t kAround = 8;  // sync, start, command, length, CRC, end
constexpr std::size_t kQuaternion = 0, kEuler = 1, kMatrix = 2, kGyro = 3, kAccel = 4, kMagnetometer = 5,
                      kTemperature = 6, kTime = 11, kStatus = 12;

}  // namespace

SbgIg500::SbgIg500(const Settings& settings)
    : Parser{kMostData + kAround},
      R_BS_{settings.R_BS},
      mask_{settings.output_mask},
      little_{settings.little_endian},
      buffer_size_{ig500::buffer_size(settings.output_mask)} {
  std::size_t at = 0;
  for (std::size_t bit = 0; bit < ig500::kOutputs; ++bit) {
    at_[bit] = at;
    if (has(bit)) at += ig500::output_size(bit);
  }
}

Parser::Look SbgIg500::look(Bytes bytes) const {
  if (bytes[0] != 0xFF) return skip_to(bytes, 0xFF);
  if (bytes.size() < 5) return bytes.size() > 1 && bytes[1] != 0x02 ? skip(1) : kMore;
  if (bytes[1] != 0x02) return skip(1);
  const std::size_t size = big<std::uint16_t>(bytes, 3);
  if (size > kMostData) return kBadFrame;
  if (bytes.size() < size + kAround) return kMore;
  if (bytes[size + 7] != 0x03) return kBadFrame;
  if (!checksum_right(big<std::uint16_t>(bytes, size + 5), crc16_reflected(bytes.subspan(2, size + 3), 0)))
    return kBadChecksum;
  if (bytes[2] == ig500::kContinuous && size != buffer_size_) {
    complain("data frames do not have the length of the configured output mask; let the driver configure it");
    return kBadFrame;
  }
  return whole_frame(size + kAround);
}

float SbgIg500::real(std::size_t at) const { return little_ ? little<float>(data_, at) : big<float>(data_, at); }

std::uint32_t SbgIg500::word(std::size_t at) const {
  return little_ ? little<std::uint32_t>(data_, at) : big<std::uint32_t>(data_, at);
}

Eigen::Vector3d SbgIg500::vector(std::size_t bit) const {
  const std::size_t at = at_[bit];
  return {real(at), real(at + 4), real(at + 8)};
}

void SbgIg500::take(Frame& frame) {
  command_ = frame.bytes[2];
  data_ = frame.bytes.subspan(5, frame.bytes.size() - kAround);
  crc_ = big<std::uint16_t>(frame.bytes, frame.bytes.size() - 3);
  if (command_ == ig500::kContinuous) read_outputs(frame);
}

void SbgIg500::read_outputs(Frame& frame) {
  sample_ = {};
  if (has(kGyro)) {
    sample_.w_WB_B = vector(kGyro);
    sample_.has_rates = true;
  }
  if (has(kAccel)) {
    sample_.f_B = vector(kAccel);
    sample_.has_specific_force = true;
  }
  if (has(kQuaternion)) {
    const std::size_t at = at_[kQuaternion];
    const Eigen::Quaterniond q{real(at), real(at + 4), real(at + 8), real(at + 12)};
    sample_.q_WB = q.normalized() * Eigen::Quaterniond{R_BS_.transpose()};
    sample_.has_attitude = q.norm() > 0.5;
  } else if (has(kEuler)) {
    sample_.q_WB = body_attitude(vector(kEuler), R_BS_);
    sample_.has_attitude = true;
  } else if (has(kMatrix)) {
    Eigen::Matrix3d R_WS;
    for (Eigen::Index i = 0; i < 9; ++i) R_WS(i % 3, i / 3) = real(at_[kMatrix] + 4 * static_cast<std::size_t>(i));
    sample_.q_WB = Eigen::Quaterniond{R_WS * R_BS_.transpose()}.normalized();
    sample_.has_attitude = std::abs(R_WS.determinant() - 1.0) < 0.1;
  }
  if (has(kTime)) frame.device_time = 1e-3 * word(at_[kTime]);
  mount(sample_, R_BS_);
  frame.lacks = "a number is none";
  if (!sample_.w_WB_B.allFinite() || !sample_.f_B.allFinite() || !sample_.q_WB.coeffs().allFinite()) return;
  frame.sample = &sample_;
}

void SbgIg500::describe(Fields& fields) const {
  fields.add_hex("cmd", command_, 2);
  fields.add("len", data_.size());
  fields.add_hex("crc", crc_, 4);
  const bool outputs = command_ == ig500::kContinuous;
  const auto reals = [&](std::size_t bit, std::initializer_list<const char*> names) {
    std::size_t at = at_[bit];
    for (const char* name : names) {
      if (!has(bit)) continue;
      if (outputs) {
        fields.add(name, real(at));
      } else {
        fields.add(name, "");
      }
      at += 4;
    }
  };
  reals(kQuaternion, {"q0", "q1", "q2", "q3"});
  reals(kEuler, {"roll_rad", "pitch_rad", "yaw_rad"});
  reals(kMatrix, {"m11", "m21", "m31", "m12", "m22", "m32", "m13", "m23", "m33"});
  reals(kGyro, {"gyro_x_radps", "gyro_y_radps", "gyro_z_radps"});
  reals(kAccel, {"accel_x_mps2", "accel_y_mps2", "accel_z_mps2"});
  reals(kMagnetometer, {"mag_x", "mag_y", "mag_z"});
  reals(kTemperature, {"temp_1_c", "temp_2_c"});
  if (has(kTime)) fields.add("time_ms", outputs ? std::optional{word(at_[kTime])} : std::nullopt);
  if (has(kStatus)) {
    if (outputs) {
      fields.add_hex("status", word(at_[kStatus]), 8);
    } else {
      fields.add("status", "");
    }
  }
  std::array<char, 2 * kMostData> text{};
  for (std::size_t i = 0; i < data_.size(); ++i) {
    text[2 * i] = "0123456789abcdef"[data_[i] >> 4];
    text[2 * i + 1] = "0123456789abcdef"[data_[i] & 0xFU];
  }
  fields.add("data_hex", std::string_view{text.data(), 2 * data_.size()});
}

}  // namespace fathom::devices

#include "common/devices/inertial/microstrain_gx3.hpp"

#include "common/devices/attitude.hpp"
#include "common/devices/checksum.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kLongest = 79;
constexpr double kGravity = 9.80665;     // m/s^2 in the instrument's "g"
constexpr double kTick = 1.0 / 62500.0;  // s
constexpr std::uint8_t kAccelRate = 0xC2, kAccelRateMag = 0xCB, kAll = 0xCC, kEulerRate = 0xCF;

std::size_t size_of(std::uint8_t name) {
  switch (name) {
    case kAccelRate:
    case kEulerRate:
      return 31;
    case kAccelRateMag:
      return 43;
    case kAll:
      return 79;
    default:
      return 0;
  }
}

Eigen::Vector3d vector(Bytes bytes, std::size_t at) {
  return {big<float>(bytes, at), big<float>(bytes, at + 4), big<float>(bytes, at + 8)};
}

}  // namespace

MicrostrainGx3::MicrostrainGx3(const Settings& settings) : Parser{kLongest}, R_BS_{settings.R_BS} {}

Parser::Look MicrostrainGx3::look(Bytes bytes) const {
  const std::size_t size = size_of(bytes[0]);
  if (size == 0) return skip(1);
  if (bytes.size() < size) return kMore;
  if (!checksum_right(big<std::uint16_t>(bytes, size - 2), sum16(bytes.first(size - 2)))) return kBadChecksum;
  return whole_frame(size);
}

// Acceleration is specific force: in the recording it points 146 degrees away from the magnetic field, which points
// down in the north.
void MicrostrainGx3::take(Frame& frame) {
  bytes_ = frame.bytes;
  const std::uint8_t name = bytes_[0];
  sample_ = {};
  sample_.w_WB_B = vector(bytes_, 13);
  sample_.has_rates = true;
  if (name == kEulerRate) {
    sample_.q_WB = body_attitude(vector(bytes_, 1), R_BS_);
    sample_.has_attitude = true;
  } else {
    sample_.f_B = vector(bytes_, 1) * kGravity;
    sample_.has_specific_force = true;
  }
  if (name == kAll) {  // the matrix turns vectors of the world into the instrument's axes; row by row
    Eigen::Matrix3d R_SW;
    for (Eigen::Index i = 0; i < 9; ++i) R_SW(i / 3, i % 3) = big<float>(bytes_, 37 + 4 * static_cast<std::size_t>(i));
    sample_.q_WB = Eigen::Quaterniond{R_SW.transpose() * R_BS_.transpose()}.normalized();
    sample_.has_attitude = std::abs(R_SW.determinant() - 1.0) < 0.1;
  }
  frame.device_time = kTick * big<std::uint32_t>(bytes_, bytes_.size() - 6);
  mount(sample_, R_BS_);
  if (sample_.w_WB_B.allFinite() && sample_.f_B.allFinite() && sample_.q_WB.coeffs().allFinite()) {
    frame.sample = &sample_;
  }
}

void MicrostrainGx3::describe(Fields& fields) const {
  fields.add_hex("id", bytes_[0], 2);
  const auto ticks = big<std::uint32_t>(bytes_, bytes_.size() - 6);
  fields.add("timer_ticks", ticks);
  fields.add_fixed("timer_s", kTick * ticks, 6);
  const std::size_t count = (bytes_.size() - 7) / 4;
  constexpr std::array kNames{"v1",  "v2",  "v3",  "v4",  "v5",  "v6",  "v7",  "v8",  "v9",
                              "v10", "v11", "v12", "v13", "v14", "v15", "v16", "v17", "v18"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    fields.add(kNames[i], i < count ? std::optional{big<float>(bytes_, 1 + 4 * i)} : std::nullopt);
  }
}

}  // namespace fathom::devices

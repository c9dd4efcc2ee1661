#include "common/devices/inertial/xsens.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "common/devices/attitude.hpp"
#include "common/devices/checksum.hpp"

namespace fathom::devices {
namespace {

constexpr std::uint8_t kPreamble = 0xFA, kBus = 0xFF, kMtData2 = 0x36;
constexpr std::size_t kMostData = 2048;
constexpr std::size_t kHead = 4, kWideHead = 6;  // preamble, bus, message, length; FF before a length of 16 bits
constexpr double kTick = 1e-4;                   // s of the fine sample time
constexpr std::uint32_t kFilterValid = 2;        // of the status

// Types without the nibble that tells number format (bits 0, 1) and world frame (bits 2, 3).
constexpr std::uint16_t kCounter = 0x1020, kTime = 0x1060, kQuaternion = 0x2010, kMatrix = 0x2020, kEuler = 0x2030,
                        kAcceleration = 0x4020, kRate = 0x8020, kStatusByte = 0xE010, kStatusWord = 0xE020;

std::size_t number_size(std::uint16_t id) {
  constexpr std::array<std::size_t, 4> kSizes{4, 4, 6, 8};  // float, 12.20, 16.32, double
  return kSizes[id & 3U];
}

// Bytes of an item whose type is known; 0 for the others.
std::size_t known_size(std::uint16_t id) {
  switch (id & 0xFFF0U) {
    case kCounter:
      return 2;
    case kTime:
    case kStatusWord:
      return 4;
    case kStatusByte:
      return 1;
    case kQuaternion:
      return 4 * number_size(id);
    case kMatrix:
      return 9 * number_size(id);
    case kEuler:
    case kAcceleration:
    case kRate:
      return 3 * number_size(id);
    default:
      return 0;
  }
}

// Items, each an identifier, a length and so many bytes, fill the data exactly.
template <class Visit>
bool each_item(Bytes data, const Visit& visit) {
  std::size_t at = 0;
  while (at < data.size()) {
    if (at + 3 > data.size()) return false;
    const auto id = big<std::uint16_t>(data, at);
    const std::size_t size = data[at + 2];
    const std::size_t known = known_size(id);
    at += 3;
    if (at + size > data.size() || (known != 0 && known != size)) return false;
    visit(id, at);
    at += size;
  }
  return true;
}

Bytes data_of(Bytes frame) {
  const std::size_t head = frame[3] == 0xFF ? kWideHead : kHead;
  return frame.subspan(head, frame.size() - head - 1);
}

Eigen::Matrix3d world_from(std::uint16_t id) {
  Eigen::Matrix3d R_NL;
  switch (id >> 2 & 3U) {
    case 1:  // north, east, down
      return Eigen::Matrix3d::Identity();
    case 2:  // north, west, up
      R_NL << 1, 0, 0, 0, -1, 0, 0, 0, -1;
      return R_NL;
    default:  // east, north, up
      R_NL << 0, 1, 0, 1, 0, 0, 0, 0, -1;
      return R_NL;
  }
}

const Eigen::DiagonalMatrix<double, 3> kDownward{1.0, -1.0, -1.0};  // forward, right, down from forward, left, up

}  // namespace

Xsens::Xsens(const Settings& settings) : Parser{kWideHead + kMostData + 1}, R_BS_{settings.R_BS} {}

Parser::Look Xsens::look(Bytes bytes) const {
  if (bytes[0] != kPreamble) return skip_to(bytes, kPreamble);
  if (bytes.size() < kHead) return bytes.size() > 1 && bytes[1] != kBus ? skip(1) : kMore;
  if (bytes[1] != kBus) return skip(1);
  const bool wide = bytes[3] == 0xFF;
  if (wide && bytes.size() < kWideHead) return kMore;
  const std::size_t size = wide ? big<std::uint16_t>(bytes, 4) : bytes[3];
  if (size > kMostData) return kBadFrame;
  const std::size_t whole = (wide ? kWideHead : kHead) + size + 1;
  if (bytes.size() < whole) return kMore;
  if (!checksum_right(0, sum16(bytes.subspan(1, whole - 1)) & 0xFFU)) return kBadChecksum;
  const bool fits = bytes[2] != kMtData2 || each_item(data_of(bytes.first(whole)), [](std::uint16_t, std::size_t) {});
  return fits ? whole_frame(whole) : kBadFrame;
}

void Xsens::find_items() {
  quaternion_ = matrix_ = euler_ = acceleration_ = rate_ = counter_ = time_ = status_byte_ = status_word_ = {};
  if (message_ != kMtData2) return;
  each_item(bytes_, [this](std::uint16_t id, std::size_t at) {
    struct Place {
      std::uint16_t type;
      Item Xsens::*item;
    };
    static constexpr std::array kPlaces{Place{kQuaternion, &Xsens::quaternion_},
                                        Place{kMatrix, &Xsens::matrix_},
                                        Place{kEuler, &Xsens::euler_},
                                        Place{kAcceleration, &Xsens::acceleration_},
                                        Place{kRate, &Xsens::rate_},
                                        Place{kCounter, &Xsens::counter_},
                                        Place{kTime, &Xsens::time_},
                                        Place{kStatusByte, &Xsens::status_byte_},
                                        Place{kStatusWord, &Xsens::status_word_}};
    for (const Place& place : kPlaces) {
      if ((id & 0xFFF0U) == place.type) this->*place.item = {id, at};
    }
  });
}

double Xsens::real(const Item& item, std::size_t i) const {
  const std::size_t at = item.at + i * number_size(item.id);
  switch (item.id & 3U) {
    case 1:
      return std::ldexp(big<std::int32_t>(bytes_, at), -20);
    case 2:  // the fraction comes before the whole part
      return big<std::int16_t>(bytes_, at + 4) + std::ldexp(big<std::uint32_t>(bytes_, at), -32);
    case 3:
      return big<double>(bytes_, at);
    default:
      return static_cast<double>(big<float>(bytes_, at));
  }
}

Eigen::Vector3d Xsens::vector(const Item& item) const { return {real(item, 0), real(item, 1), real(item, 2)}; }

// North, east, down from forward, right, down of the sensor.
std::optional<Eigen::Matrix3d> Xsens::orientation() const {
  Eigen::Matrix3d R_LS;
  const Item& item = quaternion_.at != 0 ? quaternion_ : matrix_.at != 0 ? matrix_ : euler_;
  if (quaternion_.at != 0) {
    const Eigen::Quaterniond q{real(item, 0), real(item, 1), real(item, 2), real(item, 3)};
    if (!(std::abs(q.norm() - 1.0) < 0.1)) return {};
    R_LS = q.normalized().toRotationMatrix();
  } else if (matrix_.at != 0) {  // column by column
    for (std::size_t i = 0; i < 9; ++i)
      R_LS(static_cast<Eigen::Index>(i % 3), static_cast<Eigen::Index>(i / 3)) = real(item, i);
    if (!(std::abs(R_LS.determinant() - 1.0) < 0.1)) return {};
  } else if (euler_.at != 0) {
    const Eigen::Vector3d degrees = vector(item);
    if (!(degrees.cwiseAbs().maxCoeff() <= 360.0)) return {};
    R_LS = rotation_from_euler(degrees * kRadians);
  } else {
    return {};
  }
  return world_from(item.id) * R_LS * kDownward;
}

std::optional<bool> Xsens::filter_valid() const {
  if (status_word_.at != 0) return (big<std::uint32_t>(bytes_, status_word_.at) & kFilterValid) != 0;
  if (status_byte_.at != 0) return (bytes_[status_byte_.at] & kFilterValid) != 0;
  return {};
}

void Xsens::take(Frame& frame) {
  message_ = frame.bytes[2];
  bytes_ = data_of(frame.bytes);
  find_items();
  if (message_ != kMtData2) return;
  if (time_.at != 0) frame.device_time = kTick * big<std::uint32_t>(bytes_, time_.at);
  sample_ = {};
  if (rate_.at != 0) {
    sample_.w_WB_B = kDownward * vector(rate_);
    sample_.has_rates = true;
  }
  if (acceleration_.at != 0) {
    sample_.f_B = kDownward * vector(acceleration_);
    sample_.has_specific_force = true;
  }
  const auto R_WS = orientation();
  const bool settled = filter_valid().value_or(true);
  if (R_WS && settled) {
    sample_.q_WB = Eigen::Quaterniond{*R_WS * R_BS_.transpose()}.normalized();
    sample_.has_attitude = true;
  }
  complain(settled ? ""
                   : "the sensor says that its orientation is not yet valid; keep it still, or look at its filter");
  mount(sample_, R_BS_);
  const bool says = sample_.has_rates || sample_.has_specific_force || sample_.has_attitude;
  if (!says) {
    frame.lacks = !settled ? "the sensor says that its orientation is not valid"
                           : "no orientation, rate of turn or acceleration is chosen for output";
  } else if (!sample_.w_WB_B.allFinite() || !sample_.f_B.allFinite() || !sample_.q_WB.coeffs().allFinite()) {
    frame.lacks = "a number is none";
  } else {
    frame.sample = &sample_;
  }
}

void Xsens::describe(Fields& fields) const {
  fields.add_hex("message", message_, 2);
  const auto counter = counter_.at != 0 ? std::optional{big<std::uint16_t>(bytes_, counter_.at)} : std::nullopt;
  fields.add("counter", counter);
  fields.add("time_ticks", time_.at != 0 ? std::optional{big<std::uint32_t>(bytes_, time_.at)} : std::nullopt);
  const auto reals = [&](std::initializer_list<const char*> names, const Item& item) {
    std::size_t i = 0;
    for (const char* name : names) fields.add(name, item.at != 0 ? std::optional{real(item, i++)} : std::nullopt);
  };
  const std::uint16_t id = quaternion_.at != 0 ? quaternion_.id : matrix_.at != 0 ? matrix_.id : euler_.id;
  constexpr std::array kFrames{"ENU", "NED", "NWU", "?"};
  fields.add("frame", id != 0 ? kFrames[id >> 2 & 3U] : "");
  reals({"qw", "qx", "qy", "qz"}, quaternion_);
  reals({"roll_deg", "pitch_deg", "yaw_deg"}, euler_);
  reals({"acc_x", "acc_y", "acc_z"}, acceleration_);
  reals({"gyro_x", "gyro_y", "gyro_z"}, rate_);
  const auto valid = filter_valid();
  fields.add("filter_valid", valid ? std::optional{*valid ? 1 : 0} : std::nullopt);
}

}  // namespace fathom::devices

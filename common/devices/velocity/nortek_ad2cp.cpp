#include "common/devices/velocity/nortek_ad2cp.hpp"

#include <cmath>

#include "common/devices/checksum.hpp"
#include "common/devices/text.hpp"
#include "common/devices/velocity/nortek_status.hpp"

namespace fathom::devices {
namespace {

constexpr std::uint8_t kSync = 0xA5, kBottomTrack = 0x1B;
constexpr std::size_t kHeader = 10, kWideHeader = 12;  // the latter counts the data with 32 bits
constexpr std::size_t kMostData = 16384;
// Places in the data of record 1B: clock, status, three environments, then blocks of four floats.
constexpr std::size_t kClock = 6, kStatus = 20, kEnvironment = 24, kBeams = 36, kDistances = 52, kAxes = 132,
                      kMerits = 148, kBottomSize = 212;
constexpr double kMostSpeed = 30.0;  // m/s; a float may hold anything, and no log measures more

}  // namespace

std::uint16_t nortek_checksum(Bytes bytes) {
  unsigned sum = 0xB58C;
  std::size_t i = 0;
  for (; i + 1 < bytes.size(); i += 2) sum += little<std::uint16_t>(bytes, i);
  if (i < bytes.size()) sum += static_cast<unsigned>(bytes[i]) << 8;
  return static_cast<std::uint16_t>(sum);
}

NortekAd2cp::NortekAd2cp(const Settings& settings) : Parser{kWideHeader + kMostData}, R_BS_{settings.R_BS} {}

Parser::Look NortekAd2cp::look(Bytes bytes) const {
  if (bytes[0] != kSync) return skip_to(bytes, kSync);
  if (bytes.size() < 2) return kMore;
  const std::size_t header = bytes[1];
  if (header != kHeader && header != kWideHeader) return skip(1);
  if (bytes.size() < header) return kMore;
  if (!checksum_right(little<std::uint16_t>(bytes, header - 2), nortek_checksum(bytes.first(header - 2)))) {
    return kBadChecksum;
  }
  const std::size_t size = header == kHeader ? little<std::uint16_t>(bytes, 4) : little<std::uint32_t>(bytes, 4);
  if (size == 0 || size > kMostData) return kBadFrame;
  if (bytes.size() < header + size) return kMore;
  const auto stated = little<std::uint16_t>(bytes, header - 4);
  return checksum_right(stated, nortek_checksum(bytes.subspan(header, size))) ? whole_frame(header + size)
                                                                              : kBadChecksum;
}

bool NortekAd2cp::is_bottom() const { return id_ == kBottomTrack && data_.size() >= kBottomSize; }

// Years since 1900, month from 0, and tenths of a millisecond.
std::optional<double> NortekAd2cp::clock() const {
  const auto whole = seconds_since_1970(1900 + data_[kClock], data_[kClock + 1] + 1, data_[kClock + 2],
                                        data_[kClock + 3], data_[kClock + 4], data_[kClock + 5]);
  if (!whole) return {};
  return *whole + 1e-4 * little<std::uint16_t>(data_, kClock + 6);
}

void NortekAd2cp::take(Frame& frame) {
  id_ = frame.bytes[2];
  family_ = frame.bytes[3];
  data_ = frame.bytes.subspan(frame.bytes[1]);
  frame.lacks = "a record of another kind than the bottom track of velocity logs (1B)";
  if (id_ != kBottomTrack) return;
  frame.lacks = "a bottom track that is shorter than its layout";
  if (!is_bottom()) return;
  frame.device_time = clock();
  const auto axis = [&](std::size_t i) -> std::optional<double> {
    const auto v = static_cast<double>(little<float>(data_, kAxes + 4 * i));
    const auto merit = static_cast<double>(little<float>(data_, kMerits + 4 * i));
    if (!(std::abs(v) < kMostSpeed) || !(merit < kNortekNoMerit)) return {};
    return v;
  };
  NortekReport report{.horizontal = {axis(0), axis(1)},
                      .vertical = {axis(2), axis(3)},
                      .distance = {},
                      .status = little<std::uint32_t>(data_, kStatus)};
  for (std::size_t i = 0; i < 4; ++i) report.distance[i] = little<float>(data_, kDistances + 4 * i);
  sample_ = nortek_sample(report, R_BS_);
  frame.sample = &sample_;
}

void NortekAd2cp::describe(Fields& fields) const {
  fields.add_hex("record", id_, 2);
  fields.add_hex("family", family_, 2);
  fields.add("length", data_.size());
  const bool bottom = is_bottom();
  const auto real = [&](const char* name, std::size_t at) {
    fields.add(name, bottom ? std::optional{little<float>(data_, at)} : std::nullopt);
  };
  const auto reals = [&](std::initializer_list<const char*> names, std::size_t at) {
    for (const char* name : names) {
      real(name, at);
      at += 4;
    }
  };
  fields.add("serial", bottom ? std::optional{little<std::uint32_t>(data_, 2)} : std::nullopt);
  if (bottom) {
    fields.add_hex("status", little<std::uint32_t>(data_, kStatus), 8);
  } else {
    fields.add("status", "");
  }
  reals({"sos_mps", "temp_c", "pressure_bar"}, kEnvironment);
  reals({"beam1_mps", "beam2_mps", "beam3_mps", "beam4_mps", "d1_m", "d2_m", "d3_m", "d4_m"}, kBeams);
  reals({"vx_mps", "vy_mps", "vz1_mps", "vz2_mps", "fom_x_mps", "fom_y_mps", "fom_z1_mps", "fom_z2_mps"}, kAxes);
}

}  // namespace fathom::devices

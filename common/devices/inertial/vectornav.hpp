// VectorNav VN-100 binary output: FA, groups, field masks, payload, CRC.
#pragma once

#include <array>
#include <cstdint>

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// Any choice of fields of the groups common, time, IMU and attitude. Frames with GPS or INS groups are refused: a
/// VN-100 has none, so such a header is damage.
class VectorNav final : public Parser {
 public:
  explicit VectorNav(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;

  Eigen::Matrix3d R_BS_;
  std::uint8_t groups_{};
  Bytes bytes_;                                        ///< of the latest frame
  std::array<std::array<std::uint16_t, 16>, 5> at_{};  ///< of each group's field in bytes_; 0: absent
  Ahrs sample_;
};

}  // namespace fathom::devices

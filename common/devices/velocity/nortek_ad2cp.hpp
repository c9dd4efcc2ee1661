// Nortek's binary records (AD2CP): bottom track of velocity logs, record 1B (data format 21).
#pragma once

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// Record 1B gives samples: X forward, Y to starboard, Z out of the transducers, in the vehicle's sign. Every other
/// record with right checksums is a frame only.
class NortekAd2cp final : public Parser {
 public:
  explicit NortekAd2cp(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;
  [[nodiscard]] bool is_bottom() const;
  [[nodiscard]] std::optional<double> clock() const;

  Eigen::Matrix3d R_BS_;
  std::uint8_t id_{}, family_{};
  Bytes data_;
  Dvl sample_;
};

/// Sum of the 16-bit words, little endian, from B58C; a last single byte counts as the high one.
[[nodiscard]] std::uint16_t nortek_checksum(Bytes bytes);

}  // namespace fathom::devices

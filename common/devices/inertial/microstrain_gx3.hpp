// MicroStrain 3DM-GX3: packets with a one-byte name, big-endian floats and a sum.
#pragma once

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// CB (acceleration, rate, magnetometer), C2 (acceleration, rate), CF (Euler angles, rate), CC (CB and the matrix).
class MicrostrainGx3 final : public Parser {
 public:
  explicit MicrostrainGx3(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;

  Eigen::Matrix3d R_BS_;
  Bytes bytes_;
  Ahrs sample_;
};

}  // namespace fathom::devices

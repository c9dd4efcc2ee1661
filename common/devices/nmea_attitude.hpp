// Attitude from NMEA: $PSXN,23 (roll, pitch, heading, heave), $--HDT, and the ASCII output of SBG's IG-500.
#pragma once

#include "common/devices/nmea.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// $PSXN,23 gives a sample; a heading that it leaves empty is that of the latest $--HDT. $SBG01 gives one, too.
class NmeaAttitude final : public NmeaParser {
 public:
  explicit NmeaAttitude(const Settings& settings);

 private:
  void sentence(const Words& words, Frame& frame) override;
  void describe_values(Fields& fields) const override;

  Eigen::Matrix3d R_BS_;
  std::optional<double> roll_deg_, pitch_deg_, heading_deg_, heave_m_;
  std::optional<double> true_heading_deg_;  ///< of the latest $--HDT
  Ahrs sample_;
};

}  // namespace fathom::devices

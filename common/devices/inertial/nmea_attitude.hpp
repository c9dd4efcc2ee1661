// Attitude from NMEA: $PSXN,23 (roll, pitch, heading, heave), $--HDT, $--THS, $PIXSE of iXblue's inertial systems, and
// the ASCII output of SBG's IG-500.
#pragma once

#include "common/devices/nmea.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// $PSXN,23 gives a sample; a heading that it leaves empty is that of the latest $--HDT. $SBG01 gives one, too.
/// $PIXSE,ATITUD gives one with the heading that came since the one before it: iXblue's blocks begin with the heading.
/// Its pitch is positive with the bow down, its roll with the port side up.
class NmeaAttitude final : public NmeaParser {
 public:
  explicit NmeaAttitude(const Settings& settings);

 private:
  void sentence(const Words& words, Frame& frame) override;
  void describe_values(Fields& fields) const override;
  void read_heading(const Words& words, Frame& frame);
  void read_pixse(const Words& words, Frame& frame);
  void tell(double pitch_deg, Frame& frame);

  Eigen::Matrix3d R_BS_;
  std::optional<double> roll_deg_, pitch_deg_, heading_deg_, heave_m_;
  std::optional<double> true_heading_deg_;   ///< of the latest $--HDT
  std::optional<double> block_heading_deg_;  ///< of the block that goes on: taken by its $PIXSE,ATITUD
  bool aligning_{false};                     ///< $PIXSE,ALGSTS: heading, roll and pitch are not yet known
  Ahrs sample_;
};

}  // namespace fathom::devices

// Cerulean's velocity logs: $DVPDL and $DVPDX, how far the vehicle has moved since the message before.
#pragma once

#include <optional>

#include "common/devices/nmea.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// A displacement in the vehicle's axes over the stated interval becomes the mean velocity in it, at its middle. The
/// axes are ArduSub's (forward, right, down). Confidence 0 is no measurement; $DVPDX tells the distance to the bottom
/// besides.
class Cerulean final : public NmeaParser {
 public:
  explicit Cerulean(const Settings& settings);

 private:
  void sentence(const Words& words, Frame& frame) override;
  void describe_values(Fields& fields) const override;

  Eigen::Matrix3d R_BS_;
  std::optional<double> time_us_, interval_us_, dx_m_, dy_m_, dz_m_, confidence_, standoff_m_;
  Dvl sample_;
};

}  // namespace fathom::devices

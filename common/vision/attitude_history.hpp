// Attitude at the time of a picture: between the samples of the attitude sensor, or a little ahead of the last one.
#pragma once

#include <deque>
#include <optional>

#include "common/samples/sensors.hpp"

namespace fathom::vision {

class AttitudeHistory {
 public:
  void hear(const Ahrs& sample);
  /// q_WB; nothing where the sensor was silent around that time.
  [[nodiscard]] std::optional<Eigen::Quaterniond> at(Utime utime) const;
  /// Axes of the body at `to` in those at `from`, by its rates: over the short time between two pictures a gyro errs
  /// far less than the difference of two attitudes. Nothing without rates throughout.
  [[nodiscard]] std::optional<Eigen::Quaterniond> turn(Utime from, Utime to) const;
  void reset() { samples_.clear(); }

 private:
  std::deque<Ahrs> samples_;
};

}  // namespace fathom::vision

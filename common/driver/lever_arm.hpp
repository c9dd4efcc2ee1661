// From where an instrument sits to the body's origin, with the rates and the attitude that AHRS tells.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/samples/sensors.hpp"

namespace fathom::driver {

class LeverArm {
 public:
  explicit LeverArm(const Eigen::Vector3d& p_BS) : p_BS_{p_BS} {}
  /// Without an arm nothing has to be heard.
  [[nodiscard]] bool needed() const { return !p_BS_.isZero(); }
  void hear(const Ahrs& ahrs);
  /// Velocity at the origin: v - w x p. Not valid when no rates came within half a second.
  void remove(Dvl& sample) const;
  /// Depth of the origin: that of the port less how far the port is below. Level when no attitude came.
  void remove(Depth& sample) const;

 private:
  Eigen::Vector3d p_BS_;
  std::optional<Ahrs> rates_, attitude_;
};

}  // namespace fathom::driver

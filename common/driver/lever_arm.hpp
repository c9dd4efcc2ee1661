// From where an instrument sits to the body's origin, with the rates and the attitude that AHRS tells.
#pragma once

#include <Eigen/Core>
#include <array>
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
  /// Position of the origin: that of the transponder less its arm. Not valid when no attitude came within half a
  /// second.
  void remove(Usbl& sample) const;

 private:
  static constexpr std::size_t kKept = 512;  ///< samples of AHRS: fixes come seconds after they were true
  /// Rates and attitude at that time, between the samples around it that have what is asked for, or of the one
  /// alone; nothing when none is within half a second.
  [[nodiscard]] std::optional<Ahrs> at(Utime utime, bool Ahrs::*has) const;

  Eigen::Vector3d p_BS_;
  std::array<Ahrs, kKept> heard_{};
  std::size_t count_{};
};

}  // namespace fathom::driver

// Holds position and heading on the axes that are not excited, and finds the trim (a vehicle that is light floats up).
#pragma once

#include <Eigen/Core>
#include <array>

#include "common/base/spatial.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::excitation {

struct HoldSettings {
  double mass{};          ///< kg, roughly
  double inertia{};       ///< kg m^2 about z, roughly
  double bandwidth{1.0};  ///< rad/s
  double damping{1.0};
  double trim_time{6.0};  ///< s in which the trim is found
};

/// Where to be.
struct Place {
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};  ///< m
  double turned{};                                ///< rad, unwound heading since the start
};

class Hold {
 public:
  Hold(const HoldSettings& settings, const Vector6d& largest) : settings_{settings}, largest_{largest} {}

  /// Wrench for the held axes X Y Z N, trim included; the trim stays on axes that are not held. `dt` [s] since the
  /// last.
  [[nodiscard]] Vector6d step(const StateEstimate& state, double turned, const Place& place,
                              const std::array<bool, 6>& held, double dt);
  [[nodiscard]] const Eigen::Vector3d& trim() const { return trim_W_; }  ///< N in W
  void reset() { trim_W_.setZero(); }

 private:
  HoldSettings settings_;
  Vector6d largest_;
  Eigen::Vector3d trim_W_{Eigen::Vector3d::Zero()};
};

}  // namespace fathom::excitation

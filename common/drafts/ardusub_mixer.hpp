// From the pilot's sticks to the commands of the motors, as ArduSub mixes them in MANUAL mode.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/drafts/ardusub_frames.hpp"

namespace fathom::drafts {

/// Each between -1 and 1. Positive: to starboard side down, bow up, to starboard, up, ahead, to starboard.
struct Sticks {
  double roll{}, pitch{}, yaw{}, throttle{}, forward{}, lateral{};
};

/// What a log of sticks cannot say is left out: limits of current and of throttle, a motor that is still spooling up.
/// Other modes than MANUAL mix what their controllers ask.
class ArdusubMixer {
 public:
  /// `reversed`: outputs, 1 the first, whose MOT_n_DIRECTION is -1. `coupling`: MOT_FV_CPLNG_K, of frame vectored
  /// alone. InputError for a frame or an output that is not there.
  ArdusubMixer(const std::string& frame, double coupling, const std::vector<int>& reversed);
  [[nodiscard]] std::size_t motors() const { return frame_->motors.size(); }
  /// Commands between -1 and 1, one per motor.
  void mix(const Sticks& sticks, std::span<double> commands) const;

 private:
  [[nodiscard]] double ahead_of(const FrameMotor& motor, const Sticks& sticks) const;

  const ArdusubFrame* frame_;
  double coupling_;
  std::vector<double> direction_;  ///< 1 or -1
};

}  // namespace fathom::drafts

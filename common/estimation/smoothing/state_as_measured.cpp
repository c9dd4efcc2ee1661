#include "common/estimation/smoothing/state_as_measured.hpp"

namespace fathom::estimation {

bool take_state_as_measured(Recording& recording) {
  if (!recording.pose_capture.empty() || recording.state.empty()) return false;
  const bool velocity = recording.dvl.empty();
  recording.one_estimate = velocity;
  recording.pose_estimated = true;
  for (const StateEstimate& state : recording.state) {
    recording.pose_capture.push_back(
        {.utime = state.utime, .p_WB = state.p_WB, .q_WB = state.q_WB, .valid = state.valid});
    if (velocity) recording.dvl.push_back({.utime = state.utime, .v_WB_B = state.nu.head<3>(), .valid = state.valid});
  }
  // It has gone into STATE already: where a filter smooths, the two would differ and prove nothing.
  for (Ahrs& ahrs : recording.ahrs) ahrs.has_specific_force = false;
  return true;
}

}  // namespace fathom::estimation

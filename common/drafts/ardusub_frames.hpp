// ArduSub's frames: along what and about what each motor output pushes.
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "common/drafts/draft.hpp"

namespace fathom::drafts {

/// Share of a full command of each kind that goes to one motor. Positive: roll to starboard, bow up, to starboard, up,
/// ahead, to starboard.
struct FrameMotor {
  double roll, pitch, yaw, throttle, forward, lateral;
};

struct ArdusubFrame {
  std::string_view name;  ///< as FRAME_CONFIG has it, in small letters
  std::span<const FrameMotor> motors;
};

[[nodiscard]] std::span<const ArdusubFrame> ardusub_frames();
/// InputError that names the known ones.
[[nodiscard]] const ArdusubFrame& ardusub_frame(const std::string& name);

/// Directions by the frame; `places` [m] by the number of the motor output, 1 the first. InputError for a frame or
/// motor that is not there, and for a place at which the motor would turn the vehicle the other way than the frame
/// says.
[[nodiscard]] Draft draft_of_frame(const std::string& name, const std::map<int, Eigen::Vector3d>& places);

}  // namespace fathom::drafts

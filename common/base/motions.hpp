#pragma once

#include <array>

namespace fathom {

/// Motions along and about the body's axes, in the order of nu.
inline constexpr std::array<const char*, 6> kMotionNames{"surge", "sway", "heave", "roll", "pitch", "yaw"};

}  // namespace fathom

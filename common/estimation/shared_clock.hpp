// Do several recordings tell one story? Files of one session share a clock: what begins in one of them (a payload lost,
// a wave's phase) goes on in the next. Files that each begin at zero, or lie far apart, have a clock each.
#pragma once

#include <span>

#include "common/samples/recording.hpp"
#include "common/samples/trial.hpp"

namespace fathom::estimation {

/// Longest pause inside a session, s.
inline constexpr double kSessionPause = 600.0;

/// Moves the times of `trials` (one per recording, same order) to a common origin, the earliest stamp of all, when no
/// two recordings overlap and none lies further than kSessionPause from its neighbour. True when it did.
bool share_clock(std::span<const Recording> recordings, std::span<Trial> trials);

}  // namespace fathom::estimation

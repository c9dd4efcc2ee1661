// A Recording to an LCM event log that lcm-logplayer, lcm-spy and every process can read.
#pragma once

#include <cstdint>
#include <string>

#include "common/samples/recording.hpp"

namespace fathom::wire {

/// Writes all streams merged in the order of time, each event stamped with its sample's utime: the same recording gives
/// the same bytes. Returns the number of events. InputError when a sample holds what a reader would refuse (then
/// nothing is written), or when the disk is full.
std::uint64_t write_log(const Recording& recording, const std::string& path);

}  // namespace fathom::wire

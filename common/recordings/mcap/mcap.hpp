// MCAP (.mcap): records in the order of the file, chunks unpacked one at a time. The summary at the end is a hint, and
// is not needed. Messages of ROS 1 and 2 are read; others are named and counted.
#pragma once

#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::mcap {

[[nodiscard]] bool is_mcap(Bytes head);
void read(const std::string& path, Sink& sink, Damage& damage);

}  // namespace fathom::recordings::mcap

// ROS 2 bag in SQLite (.db3): messages in the order of the file. Opened for reading only; nothing is left beside it.
#pragma once

#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::rosbag2 {

[[nodiscard]] bool is_sqlite(Bytes head);
/// InputError when it is another database, or so damaged that no message can be had.
void read(const std::string& path, Sink& sink, Damage& damage);

}  // namespace fathom::recordings::rosbag2

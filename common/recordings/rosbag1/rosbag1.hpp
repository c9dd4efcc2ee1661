// ROS 1 bag, version 2.0 (.bag, .bag.active): chunks in the order of the file; no index is needed.
#pragma once

#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::rosbag1 {

[[nodiscard]] bool is_bag(Bytes head);
/// InputError for another version.
void read(const std::string& path, Sink& sink, Damage& damage);

}  // namespace fathom::recordings::rosbag1

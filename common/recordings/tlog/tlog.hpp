// MAVLink telemetry log (.tlog): each frame behind the time of its receipt, eight bytes, the greatest first, us since
// 1970. A frame is believed for its checksum; one that is wrong is passed over whole where the next stands behind it.
#pragma once

#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::tlog {

[[nodiscard]] bool is_tlog(Bytes head);
void read(const std::string& path, Sink& sink, Damage& damage);

}  // namespace fathom::recordings::tlog

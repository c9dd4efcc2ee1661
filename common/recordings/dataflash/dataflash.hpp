// ArduPilot DataFlash, binary (.BIN) and text (.log): records that a record of kind FMT describes. No checksum: a
// record is believed when another begins behind it, or when its time fits those before.
#pragma once

#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::dataflash {

[[nodiscard]] bool is_binary(Bytes head);
void read_binary(const std::string& path, Sink& sink, Damage& damage);

[[nodiscard]] bool is_text(Bytes head);
void read_text(const std::string& path, Sink& sink, Damage& damage);

}  // namespace fathom::recordings::dataflash

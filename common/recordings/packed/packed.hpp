// A whole recording packed by zstd (bag.db3.zstd): unpacked beside the others' temporary files, and read as what it is.
#pragma once

#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::packed {

[[nodiscard]] bool is_zstd(Bytes head);
void read(const std::string& path, Sink& sink, Damage& damage);

}  // namespace fathom::recordings::packed

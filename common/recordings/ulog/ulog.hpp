// PX4 ULog (.ulg). A message is believed when its kind, its length and what it refers to are right; behind damage the
// reader goes on where two such messages follow each other.
#pragma once

#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::ulog {

[[nodiscard]] bool is_ulog(Bytes head);
/// InputError for a file that asks for what this reader does not know.
void read(const std::string& path, Sink& sink, Damage& damage);

}  // namespace fathom::recordings::ulog

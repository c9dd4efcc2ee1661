// The formats that can be read: one line each. A file is recognised by its first bytes, whatever its name.
#pragma once

#include <span>
#include <string>

#include "common/recordings/damage.hpp"
#include "common/recordings/file_window.hpp"
#include "common/recordings/stamp_guard.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings {

struct Format {
  const char* name;   ///< "dataflash"
  const char* title;  ///< "ArduPilot DataFlash"
  ClockRules clock;
  /// `head`: the first 64 KiB, or all of a shorter file.
  bool (*recognises)(Bytes head);
  /// Everything readable goes to the sink, what is not to `damage`. InputError where there is no beginning.
  void (*read)(const std::string& path, Sink& sink, Damage& damage);
};

/// In the order in which they are asked.
[[nodiscard]] std::span<const Format> formats();
/// Null when no format knows the file (a table of text, say). InputError when it cannot be opened, or holds what is
/// known and cannot be read.
[[nodiscard]] const Format* format_of(const std::string& path);

}  // namespace fathom::recordings

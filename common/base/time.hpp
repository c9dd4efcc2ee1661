// Time as messages carry it: microseconds since the epoch, when the value was true.
#pragma once

#include <cmath>
#include <cstdint>

namespace fathom {

using Utime = std::int64_t;  ///< [us]

/// Seconds from `origin` to `utime`.
[[nodiscard]] inline double seconds_between(Utime origin, Utime utime) {
  return static_cast<double>(utime - origin) * 1e-6;
}

/// Nearest microsecond to `seconds` after `origin`.
[[nodiscard]] inline Utime utime_after(Utime origin, double seconds) {
  return origin + static_cast<Utime>(std::llround(seconds * 1e6));
}

}  // namespace fathom

// Time as messages carry it: microseconds since the epoch, when the value was true.
#pragma once

#include <cmath>
#include <cstdint>

namespace fathom {

using Utime = std::int64_t;  ///< [us]

/// Up to here (the year 2255) a double holds every microsecond.
inline constexpr Utime kLatest = Utime{1} << 53U;

/// False for what no clock shows: a broken message.
[[nodiscard]] inline bool is_time(Utime utime) { return utime > -kLatest && utime < kLatest; }

/// Seconds from `origin` to `utime`; exact to the bit where both are times, and without overflow where not.
[[nodiscard]] inline double seconds_between(Utime origin, Utime utime) {
  return (static_cast<double>(utime) - static_cast<double>(origin)) * 1e-6;
}

/// Nearest microsecond to `seconds` after `origin`.
[[nodiscard]] inline Utime utime_after(Utime origin, double seconds) {
  return origin + static_cast<Utime>(std::llround(seconds * 1e6));
}

}  // namespace fathom

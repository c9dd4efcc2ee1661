// Time stamps as dates: "2024-05-27T09:40:00.500Z" (ISO 8601, UTC).
#pragma once

#include <optional>
#include <string>

#include "common/base/time.hpp"

namespace fathom {

/// To the millisecond. Nothing for stamps before the year 2000: those of a clock that knows no date.
[[nodiscard]] std::optional<std::string> utc_text(Utime utime);

}  // namespace fathom

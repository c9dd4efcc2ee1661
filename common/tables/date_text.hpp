// Dates and times of day as loggers write them, to seconds.
#pragma once

#include <optional>
#include <string_view>

namespace fathom::tables {

/// What a text says of time.
struct DateText {
  double seconds{};  ///< since 1970-01-01 00:00 UTC; of a time of day alone, since midnight
  bool day_only{};   ///< a date without a time of day
  bool time_only{};  ///< a time of day without a date
  bool zone{};       ///< it names its zone; without one UTC is assumed
};

/// "2024-05-27T09:40:00.5Z", "2024-05-27 09:40:00+02:00", "2024/05/27 09:40", "20240527T094000", "27.05.2024 09:40:00",
/// "2024-05-27", "09:40:00.250". Nothing for a date whose day and month could change places ("05/06/2024"), and for
/// what is no date of the calendar.
[[nodiscard]] std::optional<DateText> read_date(std::string_view text);

/// Whether these can be seconds since 1970 and, being so many, hardly anything else: of the years 2001 to 2096.
[[nodiscard]] constexpr bool is_since_1970(double seconds) { return seconds >= 1e9 && seconds <= 4e9; }

}  // namespace fathom::tables

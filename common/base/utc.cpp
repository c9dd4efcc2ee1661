#include "common/base/utc.hpp"

#include <array>
#include <chrono>
#include <cstdio>

namespace fathom {

std::optional<std::string> utc_text(Utime utime) {
  using namespace std::chrono;
  const sys_time<microseconds> at{microseconds{utime}};
  const auto day = floor<days>(at);
  const year_month_day date{day};
  if (!is_time(utime) || date.year() < year{2000}) return std::nullopt;
  const hh_mm_ss<milliseconds> clock{floor<milliseconds>(at - day)};
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()), static_cast<int>(clock.subseconds().count()));
  return text.data();
}

}  // namespace fathom

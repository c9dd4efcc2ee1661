#include "common/tables/date_text.hpp"

#include <charconv>
#include <chrono>

namespace fathom::tables {
namespace {

constexpr double kDay = 86400.0;  // s

/// Takes a text apart from its front.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}
  [[nodiscard]] bool end() const { return text_.empty(); }
  [[nodiscard]] char next() const { return text_.empty() ? '\0' : text_.front(); }
  bool take(char c) {
    if (next() != c || text_.empty()) return false;
    text_.remove_prefix(1);
    return true;
  }
  /// Exactly `digits` digits.
  std::optional<int> number(std::size_t digits) {
    if (run() < digits) return std::nullopt;
    int value = 0;
    std::from_chars(text_.data(), text_.data() + digits, value);
    text_.remove_prefix(digits);
    return value;
  }
  /// How many digits stand in front.
  [[nodiscard]] std::size_t run() const {
    std::size_t count = 0;
    while (count < text_.size() && text_[count] >= '0' && text_[count] <= '9') ++count;
    return count;
  }
  /// ".250" or ",250"; 0 where there is none.
  std::optional<double> fraction() {
    if (next() != '.' && next() != ',') return 0.0;
    text_.remove_prefix(1);
    const std::size_t digits = run();
    if (digits == 0) return std::nullopt;
    double value = 0.0, place = 0.1;
    for (std::size_t i = 0; i < digits; ++i, place *= 0.1) value += place * (text_[i] - '0');
    text_.remove_prefix(digits);
    return value;
  }

 private:
  std::string_view text_;
};

std::optional<double> take_day(Scanner& scan) {
  const std::size_t digits = scan.run();
  std::optional<int> year, month, day;
  if (digits == 8) {  // 20240527
    year = scan.number(4), month = scan.number(2), day = scan.number(2);
  } else if (digits == 4) {  // 2024-05-27, 2024/05/27
    year = scan.number(4);
    const char part = scan.next();
    if ((part != '-' && part != '/') || !scan.take(part)) return std::nullopt;
    month = scan.number(2);
    if (!scan.take(part)) return std::nullopt;
    day = scan.number(2);
  } else if (digits == 2) {  // 27.05.2024: only with points is the day surely first
    day = scan.number(2);
    if (!scan.take('.')) return std::nullopt;
    month = scan.number(2);
    if (!scan.take('.')) return std::nullopt;
    year = scan.number(4);
  }
  if (!year || !month || !day) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year{*year}, std::chrono::month{static_cast<unsigned>(*month)},
                                         std::chrono::day{static_cast<unsigned>(*day)}};
  if (!date.ok()) return std::nullopt;
  return kDay * static_cast<double>(std::chrono::sys_days{date}.time_since_epoch().count());
}

std::optional<double> take_time_of_day(Scanner& scan) {
  const bool compact = scan.run() == 6;
  const auto hour = scan.number(2);
  if (!hour || (!compact && !scan.take(':'))) return std::nullopt;
  const auto minute = scan.number(2);
  if (!minute || *hour > 24 || *minute > 59) return std::nullopt;
  double second = 0.0;
  if (compact || scan.take(':')) {
    const auto whole = scan.number(2);
    const auto part = scan.fraction();
    if (!whole || !part || *whole > 60) return std::nullopt;  // 60: a leap second
    second = *whole + *part;
  }
  return 3600.0 * *hour + 60.0 * *minute + second;
}

/// Seconds that the zone is ahead of UTC; nothing when there is no zone that is understood.
std::optional<double> take_zone(Scanner& scan) {
  if (scan.take('Z') || scan.take('z')) return 0.0;
  const char sign = scan.next();
  if ((sign != '+' && sign != '-') || !scan.take(sign)) return std::nullopt;
  const auto hours = scan.number(2);
  scan.take(':');
  const auto minutes = scan.end() ? std::optional<int>{0} : scan.number(2);
  if (!hours || !minutes) return std::nullopt;
  return (sign == '-' ? -1.0 : 1.0) * (3600.0 * *hours + 60.0 * *minutes);
}

}  // namespace

std::optional<DateText> read_date(std::string_view text) {
  DateText result;
  if (text.size() < 5 || text.size() > 40) return std::nullopt;
  if (text[2] == ':') {
    Scanner scan{text};
    const auto seconds = take_time_of_day(scan);
    if (!seconds || !scan.end()) return std::nullopt;
    return DateText{.seconds = *seconds, .time_only = true};
  }
  Scanner scan{text};
  const auto day = take_day(scan);
  if (!day) return std::nullopt;
  result.seconds = *day;
  if (scan.end()) {
    if (text.size() == 8) return std::nullopt;  // eight digits alone are a number
    result.day_only = true;
    return result;
  }
  if (!scan.take('T') && !scan.take(' ') && !scan.take('_')) return std::nullopt;
  while (scan.take(' ')) {
  }
  const auto seconds = take_time_of_day(scan);
  if (!seconds) return std::nullopt;
  result.seconds += *seconds;
  while (scan.take(' ')) {
  }
  if (scan.end()) return result;
  const auto zone = take_zone(scan);
  if (!zone || !scan.end()) return std::nullopt;
  result.seconds -= *zone;
  result.zone = true;
  return result;
}

}  // namespace fathom::tables

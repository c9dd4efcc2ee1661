#include "common/devices/text.hpp"

#include <charconv>
#include <chrono>
#include <cmath>

namespace fathom::devices {
namespace {

constexpr std::size_t kLongestNumber = 40;

bool digit(char c) { return c >= '0' && c <= '9'; }

// Most numbers of instruments have few digits: mantissa and power of ten are exact doubles, and so is one division.
constexpr std::array<double, 16> kTens{1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                       1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

}  // namespace

std::optional<double> number(std::string_view text, bool exponent) {
  if (text.empty() || text.size() > kLongestNumber) return {};
  std::size_t i = 0;
  const bool negative = text[0] == '-';
  if (text[0] == '+' || text[0] == '-') i = 1;
  const std::string_view unsigned_text = text.substr(i);
  std::uint64_t mantissa = 0;
  std::size_t digits = 0;
  std::size_t decimals = 0;
  for (; i < text.size() && digit(text[i]); ++i, ++digits) {
    if (digits < 15) mantissa = mantissa * 10 + static_cast<std::uint64_t>(text[i] - '0');
  }
  if (digits == 0) return {};
  if (i < text.size() && text[i] == '.') {
    for (++i; i < text.size() && digit(text[i]); ++i, ++digits, ++decimals) {
      if (digits < 15) mantissa = mantissa * 10 + static_cast<std::uint64_t>(text[i] - '0');
    }
    if (decimals == 0) return {};
  }
  const bool plain = i == text.size();
  if (!plain) {
    if (!exponent || (text[i] != 'e' && text[i] != 'E')) return {};
    ++i;
    if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
    if (i == text.size()) return {};
    for (; i < text.size(); ++i) {
      if (!digit(text[i])) return {};
    }
  }
  double value = 0.0;
  if (plain && digits <= 15) {
    value = static_cast<double>(mantissa) / kTens[decimals];
  } else {
    const char* end = unsigned_text.data() + unsigned_text.size();
    const auto [stop, error] = std::from_chars(unsigned_text.data(), end, value);
    if (error != std::errc{} || stop != end) return {};
  }
  return negative ? -value : value;
}

std::optional<std::int64_t> whole(std::string_view text) {
  if (text.empty() || !digit(text[0])) return {};
  std::int64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return {};
  return value;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::optional<std::uint8_t> hex_byte(std::string_view text) {
  if (text.size() != 2) return {};
  std::uint8_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + 2, value, 16);
  if (error != std::errc{} || stop != text.data() + 2) return {};
  return value;
}

std::optional<double> time_of_day(std::string_view text) {
  if (text.size() < 6) return {};
  const auto hour = whole(text.substr(0, 2));
  const auto minute = whole(text.substr(2, 2));
  const auto second = number(text.substr(4));
  if (!digit(text[4]) || !hour || !minute || !second || *hour > 23 || *minute > 59 || *second >= 61.0) return {};
  return static_cast<double>(*hour) * 3600.0 + static_cast<double>(*minute) * 60.0 + *second;
}

std::optional<double> seconds_since_1970(std::int64_t year, std::int64_t month, std::int64_t day, std::int64_t hour,
                                         std::int64_t minute, double second) {
  using namespace std::chrono;
  if (year < 1 || year > 9999 || month < 1 || month > 12 || day < 1 || day > 31) return {};
  const year_month_day date{std::chrono::year{static_cast<int>(year)}, std::chrono::month{static_cast<unsigned>(month)},
                            std::chrono::day{static_cast<unsigned>(day)}};
  if (!date.ok() || hour < 0 || hour > 23 || minute < 0 || minute > 59 || !(second >= 0.0 && second < 61.0)) return {};
  const auto days = sys_days{date}.time_since_epoch().count();
  return static_cast<double>(days) * 86400.0 + static_cast<double>(hour * 3600 + minute * 60) + second;
}

Words::Words(std::string_view line, char separator) {
  while (true) {
    if (count_ == kMost) {
      too_many_ = true;
      return;
    }
    const std::size_t end = line.find(separator);
    words_[count_++] = line.substr(0, end);
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
  }
}

}  // namespace fathom::devices

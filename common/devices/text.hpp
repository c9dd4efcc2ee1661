// Words and numbers of text protocols: strict and free of the locale. Empty means "no value", never zero.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace fathom::devices {

/// "[+-]digits[.digits]", with an exponent where `exponent` allows it. Nothing for anything else: empty, blanks, "nan",
/// "inf", hexadecimal, trailing letters, or a number beyond what a double holds.
[[nodiscard]] std::optional<double> number(std::string_view text, bool exponent = false);
/// Whole number without sign.
[[nodiscard]] std::optional<std::int64_t> whole(std::string_view text);
/// Without blanks at both ends.
[[nodiscard]] std::string_view trim(std::string_view text);
/// Value of two hexadecimal digits.
[[nodiscard]] std::optional<std::uint8_t> hex_byte(std::string_view text);
/// hhmmss[.ss] to seconds of the day.
[[nodiscard]] std::optional<double> time_of_day(std::string_view text);
/// Seconds since 1970 of a date in the Gregorian calendar; nothing when there is no such date or time.
[[nodiscard]] std::optional<double> seconds_since_1970(std::int64_t year, std::int64_t month, std::int64_t day,
                                                       std::int64_t hour, std::int64_t minute, double second);

/// The next word of a line, cut off from it; empty when there is none. Any number of `separators` is one gap.
[[nodiscard]] inline std::string_view next_word(std::string_view& rest, std::string_view separators) {
  const auto between = [&](char c) { return separators.find(c) != std::string_view::npos; };
  std::size_t begin = 0;
  while (begin < rest.size() && between(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !between(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

/// A line cut at its separators, without allocation.
class Words {
 public:
  static constexpr std::size_t kMost = 40;
  Words() = default;
  Words(std::string_view line, char separator);
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] bool too_many() const { return too_many_; }
  /// Empty when there is no such word: a missing field is an empty one.
  [[nodiscard]] std::string_view operator[](std::size_t i) const { return i < count_ ? words_[i] : std::string_view{}; }
  [[nodiscard]] std::optional<double> number_at(std::size_t i) const { return number((*this)[i]); }

 private:
  std::array<std::string_view, kMost> words_{};
  std::size_t count_{};
  bool too_many_{false};
};

}  // namespace fathom::devices

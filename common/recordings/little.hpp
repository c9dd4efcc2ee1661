// Numbers out of bytes, either end first.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

namespace fathom::recordings {

/// The T at `at`, least byte first; the caller knows that it is there.
template <class T>
[[nodiscard]] T little(std::span<const std::uint8_t> bytes, std::size_t at = 0) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// The same, greatest byte first.
template <class T>
[[nodiscard]] T big(std::span<const std::uint8_t> bytes, std::size_t at = 0) {
  std::array<std::uint8_t, sizeof(T)> turned{};
  std::reverse_copy(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                    bytes.begin() + static_cast<std::ptrdiff_t>(at + sizeof(T)), turned.begin());
  return little<T>(turned);
}

/// A float of 16 bits (IEEE 754 binary16).
[[nodiscard]] inline double half(std::uint16_t bits) {
  const int exponent = bits >> 10U & 0x1F;
  const double fraction = bits & 0x3FFU;
  const double sign = (bits & 0x8000U) != 0 ? -1.0 : 1.0;
  if (exponent == 31) return fraction == 0.0 ? sign * std::numeric_limits<double>::infinity() : std::nan("");
  return sign * (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024.0 + fraction, exponent - 25));
}

}  // namespace fathom::recordings

// Numbers out of bytes, either end first.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
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

}  // namespace fathom::recordings

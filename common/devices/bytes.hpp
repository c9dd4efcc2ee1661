// Numbers inside frames: little and big endian, whatever the machine. The caller has checked the length.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace fathom::devices {

using Bytes = std::span<const std::uint8_t>;

namespace detail {
template <class T, bool kSwap>
[[nodiscard]] inline T load(Bytes bytes, std::size_t at) {
  std::uint8_t raw[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes[at + (kSwap ? sizeof(T) - 1 - i : i)];
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}
}  // namespace detail

template <class T>
[[nodiscard]] inline T little(Bytes bytes, std::size_t at) {
  return detail::load<T, std::endian::native != std::endian::little>(bytes, at);
}
template <class T>
[[nodiscard]] inline T big(Bytes bytes, std::size_t at) {
  return detail::load<T, std::endian::native != std::endian::big>(bytes, at);
}

/// Three bytes, little endian.
[[nodiscard]] inline std::uint32_t little24(Bytes bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16);
}

[[nodiscard]] inline std::string_view as_text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
[[nodiscard]] inline Bytes as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace fathom::devices

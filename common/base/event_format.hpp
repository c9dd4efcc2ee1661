// How an event lies in a log of lcm-logger.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/base/time.hpp"

namespace fathom::event_format {

// Header, big-endian: sync word, int64 event number, int64 time [us], int32 channel length, int32 data length.
inline constexpr std::size_t kHeaderSize = 28;
inline constexpr std::array<std::uint8_t, 4> kSync{0xED, 0xA1, 0xDA, 0x01};
inline constexpr std::uint32_t kLongestChannel = 63;        // liblcm refuses longer names
inline constexpr std::uint32_t kLongestMessage = 1U << 28;  // and messages above 256 MB

template <class Unsigned>
[[nodiscard]] Unsigned big_endian(std::span<const std::uint8_t> bytes) {
  Unsigned value = 0;
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) value = static_cast<Unsigned>(value << 8U) | bytes[i];
  return value;
}

struct Header {
  std::uint64_t number{};
  Utime time{};
  std::uint32_t channel_length{};
  std::uint32_t data_length{};

  explicit Header(std::span<const std::uint8_t, kHeaderSize> bytes)
      : number{big_endian<std::uint64_t>(bytes.subspan<4>())},
        time{static_cast<Utime>(big_endian<std::uint64_t>(bytes.subspan<12>()))},
        channel_length{big_endian<std::uint32_t>(bytes.subspan<20>())},
        data_length{big_endian<std::uint32_t>(bytes.subspan<24>())} {}
  [[nodiscard]] bool plausible() const {
    return channel_length > 0 && channel_length <= kLongestChannel && data_length <= kLongestMessage;
  }
  [[nodiscard]] std::uint64_t body() const { return std::uint64_t{channel_length} + data_length; }
};

/// Whether another recording begins with `next`: a logger counts its events and never logs into the past. Files that
/// were joined with `cat` hold several.
[[nodiscard]] inline bool begins_anew(const Header& before, const Header& next) {
  constexpr double kBack = 1.0;  // s: a clock that is set by a network steps back by less
  return next.number < before.number ||
         (next.number == before.number && seconds_between(next.time, before.time) > kBack);
}

}  // namespace fathom::event_format

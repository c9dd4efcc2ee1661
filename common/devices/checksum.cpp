#include "common/devices/checksum.hpp"

#include <array>
#include <numeric>

namespace fathom::devices {
namespace {

constexpr std::array<std::uint16_t, 256> reflected_table(unsigned polynomial) {
  std::array<std::uint16_t, 256> table{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value & 1U) != 0 ? value >> 1 ^ polynomial : value >> 1;
    table[i] = static_cast<std::uint16_t>(value);
  }
  return table;
}

constexpr std::array<std::uint16_t, 256> straight_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned value = i << 8;
    for (int bit = 0; bit < 8; ++bit) value = (value & 0x8000U) != 0 ? value << 1 ^ 0x1021U : value << 1;
    table[i] = static_cast<std::uint16_t>(value);
  }
  return table;
}

constexpr std::array<std::uint8_t, 256> short_table() {
  std::array<std::uint8_t, 256> table{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value & 0x80U) != 0 ? value << 1 ^ 0x07U : value << 1;
    table[i] = static_cast<std::uint8_t>(value);
  }
  return table;
}

constexpr auto kReflected = reflected_table(0x8408U);
constexpr auto kArc = reflected_table(0xA001U);
constexpr auto kStraight = straight_table();
constexpr auto kShort = short_table();

}  // namespace

std::uint16_t crc16_reflected(Bytes bytes, std::uint16_t start) {
  unsigned crc = start;
  for (const std::uint8_t byte : bytes) crc = crc >> 8 ^ kReflected[(crc ^ byte) & 0xFFU];
  return static_cast<std::uint16_t>(crc);
}

std::uint16_t crc16_arc(Bytes bytes) {
  unsigned crc = 0;
  for (const std::uint8_t byte : bytes) crc = crc >> 8 ^ kArc[(crc ^ byte) & 0xFFU];
  return static_cast<std::uint16_t>(crc);
}

std::uint16_t crc16_xmodem(Bytes bytes) {
  unsigned crc = 0;
  for (const std::uint8_t byte : bytes) crc = (crc << 8 ^ kStraight[(crc >> 8 ^ byte) & 0xFFU]) & 0xFFFFU;
  return static_cast<std::uint16_t>(crc);
}

std::uint8_t crc8(Bytes bytes) {
  std::uint8_t crc = 0;
  for (const std::uint8_t byte : bytes) crc = kShort[crc ^ byte];
  return crc;
}

std::uint16_t sum16(Bytes bytes) { return static_cast<std::uint16_t>(std::accumulate(bytes.begin(), bytes.end(), 0U)); }

std::uint8_t xor8(Bytes bytes) {
  std::uint8_t value = 0;
  for (const std::uint8_t byte : bytes) value = static_cast<std::uint8_t>(value ^ byte);
  return value;
}

}  // namespace fathom::devices

// The check sums of the instruments.
#pragma once

#include <cstdint>

#include "common/devices/bytes.hpp"

namespace fathom::devices {

/// Reflected 0x1021 from `start`: CRC-16/KERMIT (start 0: SBG) and CRC-16/MCRF4XX (start 0xFFFF: MAVLink).
[[nodiscard]] std::uint16_t crc16_reflected(Bytes bytes, std::uint16_t start);
/// 0x1021, not reflected, start 0: CRC-16/XMODEM (VectorNav). Over data and its CRC it is 0.
[[nodiscard]] std::uint16_t crc16_xmodem(Bytes bytes);
/// 0x8005 reflected, start 0: CRC-16/ARC (SeaTrac).
[[nodiscard]] std::uint16_t crc16_arc(Bytes bytes);
/// 0x07, start 0, not reflected (Water Linked).
[[nodiscard]] std::uint8_t crc8(Bytes bytes);
/// Sum of all bytes modulo 65536 (Teledyne, MicroStrain).
[[nodiscard]] std::uint16_t sum16(Bytes bytes);
/// Exclusive or of all bytes (NMEA).
[[nodiscard]] std::uint8_t xor8(Bytes bytes);

/// Whether a frame's checksum is right. A fuzzer cannot guess one, and what lies behind must be safe for any contents,
/// so its build takes every checksum.
[[nodiscard]] inline bool checksum_right(unsigned stated, unsigned computed) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  static_cast<void>(stated);
  static_cast<void>(computed);
  return true;
#else
  return stated == computed;
#endif
}

}  // namespace fathom::devices

// Where an instrument is: a serial line, a TCP server, a UDP port, or a file of its bytes.
#pragma once

#include <string>

#include "common/base/time.hpp"

namespace fathom::link {

/// "serial:///dev/ttyUSB0?baud=115200", "tcp://192.168.2.95:16171", "udp://:14550" (hears whoever speaks there, answers
/// to it), "udp://192.168.2.2:14550" (speaks first), "file://dive.raw" (recorded by a driver, or bare bytes).
struct Endpoint {
  enum class Kind { kSerial, kTcp, kUdp, kFile };
  Kind kind{};
  std::string text;  ///< as given
  std::string path;  ///< device or file
  std::string host;
  int port{};
  int baud{};
  double rate{11520.0};  ///< file of bare bytes: bytes/s at which they came
  double speed{};        ///< file: 1 as it was, 0 as fast as possible
  Utime start{};         ///< file of bare bytes: when its first byte came

  /// InputError that begins with `where` when it cannot be read.
  [[nodiscard]] static Endpoint parse(const std::string& text, const std::string& where);
};

}  // namespace fathom::link

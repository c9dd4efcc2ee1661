// What a driver keeps of its line: the raw bytes in a file, where the configuration asks for it, and counts for HEALTH.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/base/time.hpp"
#include "common/link/raw_log.hpp"

namespace fathom {
class Config;
namespace devices {
class Parser;
}
namespace link {
class Link;
}
namespace runtime {
class Process;
}
}  // namespace fathom

namespace fathom::driver {

class Watch;

class LineRecord {
 public:
  /// Key `record` of the section: a file that is made anew. InputError when it cannot be.
  LineRecord(runtime::Process& process, const Config& config);
  /// A full disk costs the recording, not the measurements.
  void write(std::span<const std::uint8_t> bytes, Utime arrival);

 private:
  runtime::Process& process_;
  std::optional<link::RawWriter> file_;
};

/// "frames 12, bad checksums 0, ...".
[[nodiscard]] std::string counts(const devices::Parser& parser, const Watch& watch, const link::Link& link);

}  // namespace fathom::driver

// Raw bytes of an instrument with the times at which they came, to be parsed again to the same messages.
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace fathom::link {

/// One read from the line.
struct RawPiece {
  Utime utime{};
  std::vector<std::uint8_t> bytes;
};

/// "FATHOMRAW1\n", then per piece: i64 utime, u32 count (little endian), bytes.
class RawWriter {
 public:
  /// InputError when the file cannot be made; one that is there already is not overwritten.
  explicit RawWriter(const std::string& path);
  void write(Utime utime, std::span<const std::uint8_t> bytes);

 private:
  std::string path_;
  std::ofstream file_;
};

/// `path`, or with ".1", ".2" ... behind it when that is taken: a process that is started again goes on recording.
[[nodiscard]] std::string free_name(const std::string& path);

/// Reads what RawWriter wrote, or bare bytes with times from a rate.
class RawReader {
 public:
  /// `start` [us] and `rate` [bytes/s] are for bare bytes. InputError when the file cannot be read.
  RawReader(const std::string& path, Utime start, double rate);
  /// Nothing at the end. InputError for a damaged recording.
  [[nodiscard]] std::optional<RawPiece> next();

 private:
  std::string path_;
  std::ifstream file_;
  bool stamped_{false};
  Utime start_;
  double rate_;
  std::uint64_t count_{};
};

}  // namespace fathom::link

// One log as it is recorded: what was written outlives a loss of power, and what a full disk leaves is whole events.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>

#include "common/base/time.hpp"

namespace lcm {
class LogFile;
}

namespace fathom::runtime {

class RecordFile {
 public:
  /// InputError when it cannot be written.
  explicit RecordFile(std::string path);
  /// Closes it; see end().
  ~RecordFile();
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;

  /// InputError, with what the system says, when the disk took not all of it.
  void write(const std::string& channel, std::span<std::uint8_t> bytes, Utime utime);
  /// To the disk. InputError as above.
  void keep();
  /// Closes it. A last event that is not whole is cut off, and a file without any is removed. Never throws.
  void end() noexcept;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Written so far [B], as far as it was whole.
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  std::string path_;
  std::unique_ptr<lcm::LogFile> log_;
  std::uint64_t size_{};             ///< B, of the events that were handed over
  std::deque<std::uint64_t> since_;  ///< where the last events begin, more of them than can be missing on the disk
};

/// path.00, path.01, ...: one more than the highest that is there, whatever is missing between; as many as there are.
[[nodiscard]] std::string next_numbered(const std::string& path);

}  // namespace fathom::runtime

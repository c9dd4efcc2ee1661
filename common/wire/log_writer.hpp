// A Recording to an LCM event log that lcm-logplayer, lcm-spy and every process can read.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/samples/recording.hpp"

namespace fathom::wire {

/// A log that is written part by part, each later than the one before, beside its place ("RUN.lcmlog.part"): only when
/// it is finished it takes the place of what was there.
class LogWriter {
 public:
  explicit LogWriter(std::string path);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// All streams merged in the order of time, each event stamped with its sample's utime. InputError when a sample
  /// holds what a reader would refuse (then nothing of this part is written), or when the disk is full.
  void append(const Recording& part);
  /// Returns the number of events. InputError when the disk is full.
  std::uint64_t finish();
  /// "POSE_CAPTURE 5980, AHRS 5980": what has been written, by channel.
  [[nodiscard]] std::string counts() const;

 private:
  class File;
  std::string path_, written_;
  std::unique_ptr<File> file_;  ///< from the first part on
  std::vector<std::pair<const char*, std::uint64_t>> counts_;
  std::uint64_t events_{};
};

/// All of a recording: the same recording gives the same bytes. Returns the number of events. InputError when a sample
/// holds what a reader would refuse (then nothing is written), or when the disk is full.
std::uint64_t write_log(const Recording& recording, const std::string& path);

}  // namespace fathom::wire

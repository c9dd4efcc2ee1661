// Reads the event log format of lcm-logger and checks its structure while reading.
// liblcm's own reader stops silently, with success, at the first damaged byte; a wrong result must not look like a
// whole one.
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/event_format.hpp"
#include "common/base/time.hpp"

namespace fathom {

/// One message as logged. The views hold until the next call of EventLog::next().
struct LogEvent {
  Utime time{};            ///< when it was logged
  std::uint64_t offset{};  ///< byte in the file where the event begins
  bool begins_anew{};      ///< another recording begins here: the file was joined of several
  std::string_view channel;
  std::span<const std::uint8_t> data;
};

class EventLog {
 public:
  /// InputError when the file cannot be read or is not an event log.
  explicit EventLog(std::string path);

  /// The next event, nothing at the end. InputError "file: byte N: ..." where something other than an event follows.
  [[nodiscard]] std::optional<LogEvent> next();

  /// One line for the operator when the last event was cut off (the logger was killed); empty otherwise.
  [[nodiscard]] const std::string& warning() const { return warning_; }
  [[nodiscard]] std::uint64_t events() const { return events_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  bool read(std::span<std::uint8_t> into);
  [[nodiscard]] std::string place() const;
  [[nodiscard]] std::string remedy() const;
  [[nodiscard]] bool another_event_follows();

  std::string path_;
  std::ifstream file_;
  std::uint64_t size_{};    ///< of the file, when opened
  std::uint64_t offset_{};  ///< of the next event
  std::uint64_t events_{};
  std::optional<event_format::Header> before_;
  std::vector<std::uint8_t> body_;  ///< channel, then data
  std::string warning_;
};

}  // namespace fathom

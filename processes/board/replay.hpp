// A log played for the page as the trial went, or faster: what was said arrives when it was said.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "common/base/event_log.hpp"

namespace fathom::board {

class Replay {
 public:
  /// `speed`: seconds of the log in one second. InputError when the file is no event log.
  Replay(const std::string& path, double speed);

  using Hear = std::function<void(std::span<const std::uint8_t> bytes)>;
  void on(const std::string& channel, Hear hear) { hears_[channel] = std::move(hear); }
  /// Plays what is due `elapsed` s after the beginning; at most so many events at once, so that a page is served
  /// meanwhile.
  void play(double elapsed);

  /// s since the log's first event, of what was played; it stands still at the end.
  [[nodiscard]] double at() const { return at_; }
  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] bool over() const { return !next_; }

 private:
  void read_next() { next_ = log_.next(); }

  EventLog log_;
  double speed_, at_{}, length_{};
  Utime begin_{};
  std::optional<LogEvent> next_;
  std::map<std::string, Hear, std::less<>> hears_;
};

}  // namespace fathom::board

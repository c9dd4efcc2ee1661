// One line on stderr that says what is being done and how long it will still take: rewritten on a terminal, else a line
// now and then.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "common/base/progress.hpp"
#include "common/base/remaining_time.hpp"

namespace fathom {

class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  /// What the work tells, from any thread, while this object lives. The line goes on by itself, so that a long step is
  /// seen to live.
  [[nodiscard]] Progress progress();
  /// Prints a line of its own beside it.
  void say(const std::string& line);
  [[nodiscard]] double elapsed() const;  ///< s

 private:
  void take(const Progress::Event& event);
  void tick(const std::stop_token& stop);
  void print();

  std::chrono::steady_clock::time_point begin_;
  bool terminal_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  double shown_{};  ///< s; what is over at once shows no line
  std::string what_;
  RemainingTime remaining_;
  std::jthread ticker_;  // last: ends before what it uses
};

}  // namespace fathom

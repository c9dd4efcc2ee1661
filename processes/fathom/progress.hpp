// One line on stderr that says what is being done: rewritten on a terminal, else a line now and then.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace fathom::tool {

class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  /// What is being done now. The line goes on counting seconds by itself, so that a long step is seen to live.
  void show(const std::string& what, double share);
  [[nodiscard]] double elapsed() const;  ///< s

 private:
  void tick(const std::stop_token& stop);
  void print();

  std::chrono::steady_clock::time_point begin_;
  bool terminal_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  double shown_{-1e9};  ///< s
  std::string what_;
  double share_{};
  std::jthread ticker_;  // last: ends before what it uses
};

}  // namespace fathom::tool

// One line on stderr that says what is being done: rewritten on a terminal, else a line now and then.
#pragma once

#include <chrono>
#include <string>

namespace fathom::tool {

class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void show(const std::string& what, double share);
  [[nodiscard]] double elapsed() const;  ///< s

 private:
  std::chrono::steady_clock::time_point begin_;
  double shown_{-1e9};  ///< s
  std::string what_;
  bool terminal_;
};

}  // namespace fathom::tool

// SIGINT, SIGTERM and SIGHUP (whoever started us is gone) as a readable file descriptor, while an object of this class
// lives. No handler, no global.
#pragma once

#include <csignal>

namespace fathom::runtime {

class StopSignal {
 public:
  /// Make it before any thread starts (liblcm starts one): threads inherit what is blocked.
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// True once one of the signals has come.
  [[nodiscard]] bool raised();

 private:
  sigset_t before_{};
  int descriptor_{-1};
  bool raised_{false};
};

}  // namespace fathom::runtime

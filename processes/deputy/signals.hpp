// The signals that concern a deputy, as a readable file descriptor.
#pragma once

#include <csignal>

namespace fathom::deputy {

class Signals {
 public:
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  void read();
  [[nodiscard]] int stops() const { return stops_; }  ///< SIGINT, SIGTERM, SIGHUP, SIGQUIT so far

 private:
  sigset_t before_{};
  int descriptor_{-1};
  int stops_{};
};

}  // namespace fathom::deputy

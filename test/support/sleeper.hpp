// A process of this host that does nothing until it is killed.
#pragma once

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>

#include "common/runtime/speakers.hpp"

namespace fathom::test {

struct Sleeper {
  pid_t pid{fork()};
  std::int64_t start{};  ///< as the kernel says
  Sleeper() {
    if (pid == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);  // it outlives no test that crashes
      while (true) pause();
    }
    start = runtime::process_start(pid).value_or(0);
  }
  ~Sleeper() { end(); }
  Sleeper(const Sleeper&) = delete;
  Sleeper& operator=(const Sleeper&) = delete;
  void end() {
    if (ended) return;
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
    ended = true;
  }
  bool ended{false};
};

}  // namespace fathom::test

#include "common/launch/ending.hpp"

#include <sys/wait.h>

#include <csignal>
#include <cstring>

namespace fathom::launch {

bool stopped_by_signal(std::int32_t wait_status) {
  if (!WIFSIGNALED(wait_status)) return false;
  const int signal = WTERMSIG(wait_status);
  return signal == SIGINT || signal == SIGTERM || signal == SIGKILL;
}

std::string describe_end(std::int32_t wait_status) {
  if (WIFSIGNALED(wait_status)) {
    const char* name = sigdescr_np(WTERMSIG(wait_status));
    return name != nullptr ? name : "signal " + std::to_string(WTERMSIG(wait_status));
  }
  return wait_status == 0 ? "" : "exit " + std::to_string(WEXITSTATUS(wait_status));
}

}  // namespace fathom::launch

#include "common/runtime/stop_signal.hpp"

#include <sys/signalfd.h>
#include <unistd.h>

#include <stdexcept>

namespace fathom::runtime {

StopSignal::StopSignal() {
  sigset_t stop;
  sigemptyset(&stop);
  sigaddset(&stop, SIGINT);
  sigaddset(&stop, SIGTERM);
  sigaddset(&stop, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &stop, &before_);
  descriptor_ = signalfd(-1, &stop, SFD_NONBLOCK | SFD_CLOEXEC);
  if (descriptor_ < 0) throw std::runtime_error("signalfd failed: too many open files?");
}

StopSignal::~StopSignal() {
  (void)raised();  // a second signal must not kill the process that is already leaving
  close(descriptor_);
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool StopSignal::raised() {
  signalfd_siginfo info;
  while (read(descriptor_, &info, sizeof info) == static_cast<ssize_t>(sizeof info)) raised_ = true;
  return raised_;
}

}  // namespace fathom::runtime

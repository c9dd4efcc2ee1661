#include "processes/fathom/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace fathom::tool {
namespace {

constexpr double kTerminalPeriod = 0.1;  // s
constexpr double kPlainPeriod = 5.0;     // s, unless something new begins

}  // namespace

ProgressLine::ProgressLine() : begin_{std::chrono::steady_clock::now()}, terminal_{isatty(STDERR_FILENO) == 1} {}

ProgressLine::~ProgressLine() {
  if (terminal_ && !what_.empty()) std::fputs("\r\033[K", stderr);
}

double ProgressLine::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void ProgressLine::show(const std::string& what, double share) {
  const double now = elapsed();
  const double period = terminal_ ? kTerminalPeriod : (what == what_ ? kPlainPeriod : 1.0);
  if (now - shown_ < period) return;
  shown_ = now;
  what_ = what;
  std::fprintf(stderr, terminal_ ? "\r\033[K%5.1f s %3.0f %% %.60s" : "%5.1f s %3.0f %% %s\n", now, 100.0 * share,
               what.c_str());
  std::fflush(stderr);
}

}  // namespace fathom::tool

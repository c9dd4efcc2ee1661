#include "processes/fathom/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace fathom::tool {
namespace {

constexpr std::chrono::milliseconds kTerminalPeriod{200};
constexpr std::chrono::milliseconds kPlainPeriod{10'000};
constexpr double kPlainSpacing = 2.0;  // s between lines that say something new

}  // namespace

ProgressLine::ProgressLine()
    : begin_{std::chrono::steady_clock::now()},
      terminal_{isatty(STDERR_FILENO) == 1},
      ticker_{[this](const std::stop_token& stop) { tick(stop); }} {}

ProgressLine::~ProgressLine() {
  ticker_.request_stop();
  ticker_.join();
  if (terminal_) std::fputs("\r\033[K", stderr);
}

double ProgressLine::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void ProgressLine::show(const std::string& what, double share) {
  const std::lock_guard lock{mutex_};
  const bool news = what != what_;
  what_ = what;
  share_ = share;
  if (!terminal_ && news && elapsed() - shown_ >= kPlainSpacing) print();
}

void ProgressLine::tick(const std::stop_token& stop) {
  std::unique_lock lock{mutex_};
  while (!stop.stop_requested()) {
    wake_.wait_for(lock, stop, terminal_ ? kTerminalPeriod : kPlainPeriod, [] { return false; });
    if (!stop.stop_requested() && !what_.empty()) print();
  }
}

void ProgressLine::print() {
  shown_ = elapsed();
  std::fprintf(stderr, terminal_ ? "\r\033[K%5.1f s %3.0f %% %.60s" : "%5.1f s %3.0f %% %s\n", shown_, 100.0 * share_,
               what_.c_str());
  std::fflush(stderr);
}

}  // namespace fathom::tool

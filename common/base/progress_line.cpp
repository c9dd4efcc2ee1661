#include "common/base/progress_line.hpp"

#include <unistd.h>

#include <cstdio>

namespace fathom {
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

Progress ProgressLine::progress() {
  return Progress{[this](const Progress::Event& event) { take(event); }};
}

void ProgressLine::take(const Progress::Event& event) {
  const std::lock_guard lock{mutex_};
  remaining_.take(elapsed(), event);
  if (event.kind != Progress::Event::Kind::kBegin) return;
  const bool news = event.what != what_;
  what_ = event.what;
  if (!terminal_ && news && elapsed() - shown_ >= kPlainSpacing) print();
}

void ProgressLine::say(const std::string& line) {
  const std::lock_guard lock{mutex_};
  std::fprintf(stderr, terminal_ ? "\r\033[K%s\n" : "%s\n", line.c_str());
  if (terminal_ && !what_.empty()) print();
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
  std::string left;
  if (const auto seconds = remaining_.left(shown_)) left = ", " + time_left(*seconds);
  std::fprintf(stderr, terminal_ ? "\r\033[K%5.1f s %.60s%s" : "%5.1f s %s%s\n", shown_, what_.c_str(), left.c_str());
  std::fflush(stderr);
}

}  // namespace fathom

#include "processes/sheriff/screen.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace fathom::sheriff {
namespace {

constexpr double kRedraw = 0.5;  // s

int lines_of(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }

}  // namespace

Screen::Screen() : terminal_{isatty(STDOUT_FILENO) == 1} {}

std::size_t Screen::width() const {
  winsize size{};
  if (terminal_ && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20) return size.ws_col - 1U;
  return 160;
}

void Screen::clear() {
  if (lines_ > 0) std::printf("\033[%dA\033[J", lines_);
  std::fflush(stdout);
  lines_ = 0;
}

void Screen::say(const std::string& line) {
  clear();
  drawn_ = -1e9;
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void Screen::show(const std::vector<launch::Sheriff::Row>& rows, const launch::HealthBoard& health,
                  const std::string& doing, double now) {
  if (terminal_) {
    if (now - drawn_ < kRedraw) return;
    drawn_ = now;
    clear();
    const std::string text = launch::table(rows, health, now, width()) + doing + "\n";
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
    lines_ = lines_of(text);
    return;
  }
  for (const auto& row : rows) {
    const launch::HealthBoard::Word word = health.of(row, now);
    const bool sick = !word.state.empty() && word.state != "running" && word.state != "stopped";
    const std::string line = row.command.id + " on " + row.deputy + ": " + launch::word(row.state) +
                             (row.state == launch::State::kRunning && sick ? ", " + word.state : "");
    const std::string key = row.command.id + " on " + row.deputy + ":";
    const auto before =
        std::find_if(told_.begin(), told_.end(), [&](const std::string& each) { return each.starts_with(key); });
    const bool idle = row.state == launch::State::kIdle || row.state == launch::State::kUnheard;
    if (before == told_.end()) {
      told_.push_back(line);
      if (!idle) say(line);
    } else if (*before != line) {
      *before = line;
      if (idle) continue;
      say(line + (sick && !word.detail.empty() ? ": " + word.detail : ""));
    }
  }
}

void Screen::finish(const std::vector<launch::Sheriff::Row>& rows, const launch::HealthBoard& health, double now) {
  clear();
  std::fputs(launch::table(rows, health, now, width()).c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace fathom::sheriff

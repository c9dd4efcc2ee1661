#include "processes/board/replay.hpp"

#include <algorithm>

#include "common/base/error.hpp"

namespace fathom::board {
namespace {

constexpr int kAtOnce = 20'000;  // events: some hundredths of a second

}  // namespace

Replay::Replay(const std::string& path, double speed) : log_{path}, speed_{speed} {
  {
    EventLog whole{path};  // how long it is
    std::optional<Utime> last;
    while (const auto event = whole.next()) {
      if (!last) begin_ = event->time;
      last = std::max(event->time, last.value_or(event->time));
    }
    if (!last) throw InputError(path + ": holds no message");
    length_ = seconds_between(begin_, *last);
  }
  read_next();
}

void Replay::play(double elapsed) {
  if (over()) return;
  const double due = speed_ * elapsed;
  for (int i = 0; next_ && i < kAtOnce; ++i) {
    const double at = seconds_between(begin_, next_->time);
    if (at > due) break;
    at_ = std::max(at_, at);
    if (const auto hear = hears_.find(next_->channel); hear != hears_.end()) hear->second(next_->data);
    read_next();
  }
  at_ = next_ ? std::max(at_, std::min(due, seconds_between(begin_, next_->time))) : length_;
}

}  // namespace fathom::board

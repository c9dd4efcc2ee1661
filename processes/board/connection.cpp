#include "processes/board/connection.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace fathom::board {

bool Connection::ready(short events) const {
  constexpr int kSliceMs = 50;  // half of what a process may take to stop
  while (!leaving_ && std::chrono::steady_clock::now() < end_) {
    pollfd one{.fd = socket_, .events = events, .revents = 0};
    const int count = ::poll(&one, 1, kSliceMs);
    if (count > 0) return true;
    if (count < 0 && errno != EINTR) return false;
  }
  return false;
}

bool Connection::is_readable() const { return begin_ < filled_ || ready(POLLIN); }
bool Connection::is_writable() const { return ready(POLLOUT); }

ssize_t Connection::read(char* to, std::size_t size) {
  if (begin_ == filled_) {
    if (received_ >= kMostBytes || !ready(POLLIN)) return -1;
    const ssize_t count = ::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (count <= 0) return count;
    begin_ = 0;
    filled_ = static_cast<std::size_t>(count);
    received_ += filled_;
  }
  const std::size_t given = std::min(size, filled_ - begin_);
  std::memcpy(to, buffer_.data() + begin_, given);
  begin_ += given;
  return static_cast<ssize_t>(given);
}

ssize_t Connection::write(const char* from, std::size_t size) {
  if (!ready(POLLOUT)) return -1;
  return ::send(socket_, from, size, MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace fathom::board

#include "processes/deputy/systemd.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>

#include "processes/deputy/environment.hpp"

namespace fathom::deputy {

Systemd::Systemd() : address_{variable("NOTIFY_SOCKET")} {
  const std::string pid = variable("WATCHDOG_PID");
  if (pid.empty() || pid == std::to_string(getpid())) {
    constexpr double kHalf = 0.5e-6;  // of it, in s per us
    period_ = kHalf * std::strtod(variable("WATCHDOG_USEC").c_str(), nullptr);
  }
  for (const char* each : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(each);
  if (!address_.empty()) socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

Systemd::~Systemd() {
  if (socket_ >= 0) close(socket_);
}

void Systemd::say(const std::string& text) const {
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  if (socket_ < 0 || address_.size() >= sizeof to.sun_path) return;
  std::copy(address_.begin(), address_.end(), std::begin(to.sun_path));
  if (address_.front() == '@') to.sun_path[0] = '\0';  // an abstract one
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  (void)sendto(socket_, text.data(), text.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&to), size);
}

void Systemd::ready(const std::string& status) { say("READY=1\nSTATUS=" + status); }
void Systemd::stopping() { say("STOPPING=1\nSTATUS=stops everything"); }

double Systemd::alive(double now) {
  if (period_ <= 0.0) return std::numeric_limits<double>::max();
  if (now >= next_) {
    say("WATCHDOG=1");
    next_ = now + period_;
  }
  return next_ - now;
}

}  // namespace fathom::deputy

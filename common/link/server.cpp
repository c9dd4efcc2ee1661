#include "common/link/server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

#include "common/base/error.hpp"

namespace fathom::link {
namespace {

int open_listener(int port, std::string& name) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (listener < 0 || bind(listener, generic, sizeof address) != 0 || listen(listener, 1) != 0) {
    if (listener >= 0) close(listener);
    throw InputError("tcp:" + std::to_string(port) + ": the port cannot be had; is another program on it?");
  }
  socklen_t size = sizeof address;
  getsockname(listener, generic, &size);
  name = "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  return listener;
}

}  // namespace

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

Server::Server(const std::string& to) {
  if (to == "pty" || to.starts_with("pty:")) {
    terminal_ = true;
    int slave = -1;
    std::array<char, 256> path{};
    if (openpty(&descriptor_, &slave, path.data(), nullptr, nullptr) != 0) {
      throw InputError(to + ": no pseudo-terminal to be had; is /dev/pts mounted?");
    }
    termios raw{};
    tcgetattr(slave, &raw);
    cfmakeraw(&raw);
    tcsetattr(slave, TCSANOW, &raw);
    close(slave);
    fcntl(descriptor_, F_SETFL, O_NONBLOCK);
    name_ = path.data();
    if (to.size() > 4) {
      link_path_ = to.substr(4);
      std::error_code failed;
      if (std::filesystem::is_symlink(link_path_)) std::filesystem::remove(link_path_, failed);
      std::filesystem::create_symlink(name_, link_path_, failed);
      if (failed) throw InputError(link_path_ + ": the link cannot be made; check that the folder exists and is yours");
      name_ = link_path_;
    }
    return;
  }
  int port = -1;
  if (to.starts_with("tcp:")) std::from_chars(to.data() + 4, to.data() + to.size(), port);
  if (port < 0 || port > 65535) throw InputError("--to " + to + ": write pty, pty:PATH or tcp:PORT");
  listener_ = open_listener(port, name_);
}

Server::~Server() {
  if (descriptor_ >= 0) close(descriptor_);
  if (listener_ >= 0) close(listener_);
  std::error_code ignored;
  if (!link_path_.empty()) std::filesystem::remove(link_path_, ignored);
}

void Server::accept_client() {
  const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (client < 0) return;
  if (descriptor_ >= 0) close(descriptor_);
  const int yes = 1;
  setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  descriptor_ = client;
}

std::string Server::wait(double seconds) {
  // A terminal that nobody has opened hangs up at once and for ever; it is looked at now and then.
  std::array<pollfd, 2> watched{pollfd{.fd = listener_, .events = POLLIN, .revents = 0},
                                pollfd{.fd = descriptor_, .events = POLLIN, .revents = 0}};
  const auto begin = std::chrono::steady_clock::now();
  const std::chrono::duration<double> limit{seconds};
  poll(watched.data(), watched.size(), static_cast<int>(std::ceil(1e3 * seconds)));
  if ((watched[0].revents & POLLIN) != 0) accept_client();
  if (watched[1].revents == 0) return {};
  std::array<char, 4096> bytes{};
  const ssize_t count = read(descriptor_, bytes.data(), bytes.size());
  if (count > 0) return {bytes.data(), static_cast<std::size_t>(count)};
  if (terminal_) {
    const auto used = std::chrono::steady_clock::now() - begin;
    if (used < limit)
      std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(limit - used, std::chrono::milliseconds{20}));
  } else if (count == 0 || (errno != EAGAIN && errno != EINTR)) {
    close(descriptor_);
    descriptor_ = -1;
  }
  return {};
}

bool Server::connected() const {
  if (descriptor_ < 0 || !terminal_) return descriptor_ >= 0;
  pollfd look{.fd = descriptor_, .events = POLLOUT, .revents = 0};
  poll(&look, 1, 0);
  return (look.revents & POLLHUP) == 0;
}

std::size_t Server::send(std::string_view bytes) {
  if (!connected()) return 0;  // without a reader the terminal would keep old bytes for the next one
  const ssize_t count = write(descriptor_, bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void Server::drain() {
  using std::chrono::milliseconds;
  constexpr milliseconds kLook{10};
  // In looks in a row. Bytes come to a terminal's reader by way of the kernel's own queue, whose worker may be late on
  // a busy machine; a reader that takes nothing for so long stands still.
  constexpr int kSettled = 50;
  constexpr int kStill = 500;
  if (!connected()) return;
  // What waits in a terminal is told at the client's end only, and is thrown away when the line goes.
  const int end = terminal_ ? open(name_.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC) : descriptor_;
  const unsigned long question = terminal_ ? FIONREAD : TIOCOUTQ;
  for (int same = 0, last = -1; same < (last == 0 ? kSettled : kStill); ++same) {
    int waiting = 0;
    if (end < 0 || ioctl(end, question, &waiting) != 0) break;
    if (waiting != last) same = 0;
    last = waiting;
    std::this_thread::sleep_for(kLook);
  }
  if (terminal_ && end >= 0) close(end);
}

}  // namespace fathom::link

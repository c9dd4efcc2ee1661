// fathom steer: a hand on the keyboard or a joystick, and a dead man: thrust only while the hand holds on.
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/printable.hpp"
#include "common/orders/hand.hpp"
#include "common/runtime/stop_signal.hpp"
#include "processes/fathom/operator/orders.hpp"

namespace fathom::tool {
namespace {

constexpr double kPeriod =
    0.1;  // s between two orders to steer; the supervisor lets none live longer than half a second
constexpr double kPromised = 2.0;  // s between signs of life: who steers is there

/// Keys as they are pressed, unseen, while an object of this class lives. What is no terminal is read as it is.
class RawTerminal {
 public:
  RawTerminal() : is_terminal_{isatty(STDIN_FILENO) != 0} {
    if (!is_terminal_) return;
    tcgetattr(STDIN_FILENO, &before_);
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  ~RawTerminal() {
    if (is_terminal_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

 private:
  bool is_terminal_;
  termios before_{};
};

/// What came on a descriptor without waiting; nothing when it has come to its end.
std::optional<std::string> bytes_of(int descriptor) {
  pollfd one{.fd = descriptor, .events = POLLIN, .revents = 0};
  if (poll(&one, 1, 0) <= 0) return std::string{};
  std::array<char, 256> buffer{};
  const ssize_t count = read(descriptor, buffer.data(), buffer.size());
  if (count > 0) return std::string(buffer.data(), static_cast<std::size_t>(count));
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return std::string{};
  return {};
}

/// Joystick or keyboard.
class Hand {
 public:
  explicit Hand(const OperatorOptions& options) : stick_{options.dead_man} {
    if (options.joystick.empty()) {
      terminal_.emplace();
      descriptor_ = STDIN_FILENO;
      std::printf("%s   space or Ctrl-C: abort\n", orders::Keyboard::kKeys);
      return;
    }
    descriptor_ = open(options.joystick.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ < 0)
      throw InputError("--joystick " + options.joystick + ": " + std::strerror(errno) + "; see: ls /dev/input/js*");
    joystick_ = true;
    std::printf("left stick ahead and sideways, right stick turns and dives, while button %d is held   Ctrl-C: abort\n",
                options.dead_man);
  }
  ~Hand() {
    if (joystick_) close(descriptor_);
  }
  Hand(const Hand&) = delete;
  Hand& operator=(const Hand&) = delete;

  /// False when it is gone or wants to abort.
  bool look(double now) {
    const auto bytes = bytes_of(descriptor_);
    if (!bytes) return false;
    if (joystick_) {
      stick_.feed(*bytes);
      return true;
    }
    for (const char key : *bytes) {
      if (key == ' ') return false;
      keys_.press(key, now);
    }
    return true;
  }
  [[nodiscard]] std::optional<Vector6d> shares(double now) const {
    return joystick_ ? stick_.shares() : keys_.shares(now);
  }

 private:
  std::optional<RawTerminal> terminal_;
  int descriptor_{-1};
  bool joystick_{false};
  orders::Keyboard keys_;
  orders::Joystick stick_;
};

double seconds() { return std::chrono::duration<double>(Console::Clock::now().time_since_epoch()).count(); }

}  // namespace

void steer(const OperatorOptions& options) {
  runtime::StopSignal stop;
  Hand hand{options};
  Console console{options.url, Console::Hears::kAll, operator_keys(options.operator_file)};
  Orders orders{console};
  go_through(console, orders, options.needs, true);
  orders.give({.enable = true, .order = "hold", .attends = kPromised}, true);
  std::fflush(stdout);
  console.excitation.reset();  // of before
  Vector6d full;
  full << Eigen::Vector3d::Constant(options.force), Eigen::Vector3d::Constant(options.moment);
  bool holds = false;  // the hand was on it
  double spoke = 0.0;
  bool silent = false;
  while (true) {
    console.listen(kPeriod, {}, stop.descriptor());
    const double now = seconds();
    if (stop.raised() || !hand.look(now)) break;
    if (console.excitation && console.excitation->mode.empty())
      throw InputError("no longer armed: " + printable(console.excitation->reason));
    if (const bool was = std::exchange(silent, console.silence() > kNobody); silent && !was) {
      std::printf("%s\n", kNobodySays);
      std::fflush(stdout);
    }
    if (const auto shares = hand.shares(now)) {
      orders.say({.order = "manual", .tau = shares->cwiseProduct(full)});
      holds = true;
    } else if (holds) {  // the hand has let go: it stays where it is
      orders.say({.order = "hold"});
      holds = false;
    } else if (now - spoke >= kPromised / 4.0) {
      orders.say({});
    } else {
      continue;
    }
    spoke = now;
  }
  abort_now(console, true);
}

}  // namespace fathom::tool

#include "common/link/link.hpp"

#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <asio.hpp>
#include <chrono>
#include <deque>
#include <optional>
#include <thread>
#include <utility>

#include "common/base/error.hpp"
#include "common/link/raw_log.hpp"

namespace fathom::link {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kFirstPause{250};
constexpr milliseconds kLongestPause{5000};
constexpr milliseconds kStoodStill{1000};  // beyond what was asked: more than a busy machine costs
constexpr std::size_t kMostWaiting = 256;  // messages to a line that does not take them

Utime wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// What waits in a line that is opened is of any age: a driver that stood still has not read it, and its successor would
// take it for now. Behind the terminal's own buffer there is the device's, which fills it again when it is empty.
void discard_waiting(int line) {
  constexpr int kMost = 20;
  int empty = 0;
  for (int i = 0; i < kMost && empty < 2; ++i) {
    int waiting = 0;
    if (ioctl(line, FIONREAD, &waiting) != 0) return;
    empty = waiting == 0 ? empty + 1 : 0;
    tcflush(line, TCIFLUSH);
    std::this_thread::sleep_for(milliseconds{1});
  }
}

std::string remedy(const Endpoint& endpoint, const asio::error_code& error) {
  const std::string& what = endpoint.text;
  if (error == asio::error::eof || error == asio::error::connection_reset || error == asio::error::broken_pipe)
    return what + ": the other side closed the line; trying again";
  if (error.value() == ENOENT || error.value() == ENODEV || error.value() == ENXIO) {
    return what + ": no such device; is it plugged in? (ls /dev/serial/by-id)";
  }
  const bool network = endpoint.kind == Endpoint::Kind::kTcp || endpoint.kind == Endpoint::Kind::kUdp;
  if (network && (error.value() == EACCES || error.value() == EPERM)) {
    return what + ": not allowed; ports below 1024 are the system's own, take a higher one";
  }
  if (error.value() == EISDIR) return what + ": is a folder; name the device in it";
  if (error.value() == EACCES || error.value() == EPERM) {
    return what + ": no permission; add the user to the group that owns it (usermod -aG dialout NAME)";
  }
  if (error.value() == EBUSY) return what + ": in use by another program; end that one";
  if (error.value() == EIO && endpoint.kind == Endpoint::Kind::kSerial)
    return what + ": the device is gone; unplugged?";
  if (error == asio::error::connection_refused)
    return what + ": nobody listens there; is the instrument on, is the port right?";
  if (error == asio::error::host_unreachable || error == asio::error::network_unreachable ||
      error == asio::error::timed_out) {
    return what + ": no way to that address; check cable and network";
  }
  if (error == asio::error::address_in_use) return what + ": another program has this port; end it or take another";
  return what + ": " + error.message();
}

}  // namespace

struct Link::State {
  State(Endpoint where, Received on_bytes, Changed on_change)
      : endpoint{std::move(where)}, received{std::move(on_bytes)}, changed{std::move(on_change)} {}

  Endpoint endpoint;
  Received received;
  Changed changed;
  asio::io_context io{1};
  asio::steady_timer timer{io};
  asio::serial_port serial{io};
  asio::ip::tcp::socket tcp{io};
  asio::ip::udp::socket udp{io};
  asio::ip::udp::endpoint peer;
  std::optional<RawReader> file;
  std::optional<RawPiece> piece;
  Utime file_begin{};
  Clock::time_point host_begin;
  std::array<std::uint8_t, 4096> buffer{};
  std::deque<std::string> outgoing;
  bool sending{false}, is_up{false}, is_finished{false}, woken{false};
  std::uint64_t opened{};
  std::uint64_t generation{};  // handlers of a line that was closed are deaf
  milliseconds pause{kFirstPause};
  Clock::time_point expected{Clock::time_point::max()};  // when the line shall have been served again

  bool stood_still();
  void open();
  void went_up();
  void went_down(const std::string& why);
  void read();
  void read_file();
  void write();
  void open_serial();
  void open_tcp();
  void open_udp();
  void open_file();
  void took(std::size_t count) {
    woken = true;
    if (stood_still()) return;
    pause = kFirstPause;  // it speaks; a line that only opens and closes is tried less and less often
    received(std::span{buffer}.first(count), wall_clock());
  }
};

/// A program that was halted, or starved, finds in its line what came meanwhile, of any age: the line is opened anew.
bool Link::State::stood_still() {
  const auto late = std::chrono::duration_cast<milliseconds>(Clock::now() - expected);
  if (!is_up || endpoint.kind == Endpoint::Kind::kFile || late < kStoodStill) return false;
  expected = Clock::time_point::max();
  const std::string seconds = std::to_string(late.count() / 1000) + "." + std::to_string(late.count() % 1000 / 100);
  went_down(endpoint.text + ": this program stood still for " + seconds +
            " s and what came meanwhile is too old; the line is opened anew (is the machine overloaded?)");
  return true;
}

void Link::State::open() {
  switch (endpoint.kind) {
    case Endpoint::Kind::kSerial:
      return open_serial();
    case Endpoint::Kind::kTcp:
      return open_tcp();
    case Endpoint::Kind::kUdp:
      return open_udp();
    case Endpoint::Kind::kFile:
      return open_file();
  }
}

void Link::State::open_serial() {
  asio::error_code error;
  serial.open(endpoint.path, error);
  using Port = asio::serial_port_base;
  if (!error) serial.set_option(Port::baud_rate(static_cast<unsigned>(endpoint.baud)), error);
  if (error.value() == EINVAL) {
    return went_down(endpoint.text + ": this device cannot do that baud rate; take one from its manual");
  }
  if (!error) serial.set_option(Port::flow_control(Port::flow_control::none), error);
  if (!error) serial.set_option(Port::parity(Port::parity::none), error);
  if (!error) serial.set_option(Port::stop_bits(Port::stop_bits::one), error);
  if (!error) serial.set_option(Port::character_size(8), error);
  if (error.value() == ENOTTY) return went_down(endpoint.text + ": is no serial line; use file:// for a file");
  if (error) return went_down(remedy(endpoint, error));
  discard_waiting(serial.native_handle());
  went_up();
}

void Link::State::open_tcp() {
  asio::error_code error;
  const auto address = asio::ip::make_address(endpoint.host == "localhost" ? "127.0.0.1" : endpoint.host, error);
  if (error) return went_down(endpoint.text + ": the host must be an address in numbers, as 192.168.2.95");
  const std::uint64_t mine = generation;
  tcp.async_connect({address, static_cast<asio::ip::port_type>(endpoint.port)}, [this, mine](asio::error_code failed) {
    if (mine != generation) return;
    if (failed) return went_down(remedy(endpoint, failed));
    tcp.set_option(asio::ip::tcp::no_delay{true}, failed);
    went_up();
  });
}

void Link::State::open_udp() {
  asio::error_code error;
  const auto port = static_cast<asio::ip::port_type>(endpoint.port);
  udp.open(asio::ip::udp::v4(), error);
  if (endpoint.host.empty()) {
    if (!error) udp.bind({asio::ip::udp::v4(), port}, error);
  } else {
    const auto address = asio::ip::make_address(endpoint.host == "localhost" ? "127.0.0.1" : endpoint.host, error);
    if (error) return went_down(endpoint.text + ": the host must be an address in numbers, as 192.168.2.2");
    peer = {address, port};
    udp.bind({asio::ip::udp::v4(), 0}, error);
  }
  if (error) return went_down(remedy(endpoint, error));
  went_up();
}

void Link::State::open_file() {
  try {
    file.emplace(endpoint.path, endpoint.start, endpoint.rate);
    piece = file->next();
  } catch (const InputError&) {
    is_finished = true;  // a file does not come back by waiting
    throw;
  }
  if (piece) file_begin = piece->utime;
  host_begin = Clock::now();
  went_up();
}

void Link::State::went_up() {
  is_up = true;
  ++opened;
  woken = true;
  changed(true, "");
  read();
}

void Link::State::went_down(const std::string& why) {
  ++generation;
  asio::error_code ignored;
  serial.close(ignored);
  tcp.close(ignored);
  udp.close(ignored);
  outgoing.clear();
  sending = false;
  is_up = false;
  woken = true;
  changed(false, why);
  timer.expires_after(pause);
  pause = std::min(2 * pause, kLongestPause);
  timer.async_wait([this](asio::error_code cancelled) {
    if (!cancelled) open();
  });
}

void Link::State::read() {
  const std::uint64_t mine = generation;
  const auto done = [this, mine](asio::error_code error, std::size_t count) {
    if (mine != generation) return;
    // A datagram that nobody took comes back as an error; the port is still good.
    const bool bounced = endpoint.kind == Endpoint::Kind::kUdp && error == asio::error::connection_refused;
    if (error && !bounced) return went_down(remedy(endpoint, error));
    if (count > 0) took(count);
    if (mine == generation) read();
  };
  if (endpoint.kind == Endpoint::Kind::kSerial) serial.async_read_some(asio::buffer(buffer), done);
  if (endpoint.kind == Endpoint::Kind::kTcp) tcp.async_read_some(asio::buffer(buffer), done);
  if (endpoint.kind == Endpoint::Kind::kUdp) udp.async_receive_from(asio::buffer(buffer), peer, done);
  if (endpoint.kind == Endpoint::Kind::kFile) read_file();
}

void Link::State::read_file() {
  if (!piece) {
    is_finished = true;
    woken = true;
    return;
  }
  auto due = host_begin;
  if (endpoint.speed > 0.0) {
    const std::chrono::duration<double> since{seconds_between(file_begin, piece->utime) / endpoint.speed};
    due += std::chrono::duration_cast<Clock::duration>(since);
  }
  timer.expires_at(due);
  timer.async_wait([this](asio::error_code cancelled) {
    if (cancelled) return;
    woken = true;
    received(piece->bytes, piece->utime);
    piece = file->next();
    read_file();
  });
}

void Link::State::write() {
  if (sending || outgoing.empty() || !is_up) return;
  sending = true;
  const std::uint64_t mine = generation;
  const auto done = [this, mine](asio::error_code error, std::size_t) {
    if (mine != generation) return;
    sending = false;
    outgoing.pop_front();
    const bool bounced = endpoint.kind == Endpoint::Kind::kUdp;
    if (error && !bounced) return went_down(remedy(endpoint, error));
    write();
  };
  const auto bytes = asio::buffer(outgoing.front());
  if (endpoint.kind == Endpoint::Kind::kSerial) asio::async_write(serial, bytes, done);
  if (endpoint.kind == Endpoint::Kind::kTcp) asio::async_write(tcp, bytes, done);
  if (endpoint.kind == Endpoint::Kind::kUdp) {
    if (peer.port() != 0) {
      udp.async_send_to(bytes, peer, done);
    } else {  // nobody has spoken yet
      sending = false;
      outgoing.clear();
    }
  }
  if (endpoint.kind == Endpoint::Kind::kFile) {
    sending = false;
    outgoing.clear();
  }
}

Link::Link(Endpoint endpoint, Received received, Changed changed)
    : state_{std::make_unique<State>(std::move(endpoint), std::move(received), std::move(changed))} {
  asio::post(state_->io, [state = state_.get()] { state->open(); });
}

Link::~Link() = default;

void Link::wait(std::span<const int> descriptors, int limit_ms) {
  State& state = *state_;
  state.woken = false;
  (void)state.stood_still();
  std::deque<asio::posix::stream_descriptor> watched;
  for (const int descriptor : descriptors) {
    watched.emplace_back(state.io, descriptor);
    watched.back().async_wait(asio::posix::stream_descriptor::wait_read, [&state](asio::error_code cancelled) {
      if (!cancelled) state.woken = true;
    });
  }
  const auto until = Clock::now() + milliseconds{limit_ms};
  state.expected = until;
  if (state.io.stopped()) state.io.restart();
  while (!state.woken && state.io.run_one_until(until) > 0) {
  }
  while (state.io.poll_one() > 0 && !state.is_finished) {
    if (Clock::now() > until) break;
  }
  for (auto& each : watched) each.release();  // the descriptor is not ours to close
}

void Link::send(std::span<const std::uint8_t> bytes) {
  if (!state_->is_up || state_->outgoing.size() >= kMostWaiting) return;
  state_->outgoing.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  state_->write();
}

void Link::send(const std::string& text) {
  send(std::span{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

bool Link::up() const { return state_->is_up; }
bool Link::finished() const { return state_->is_finished; }
std::uint64_t Link::openings() const { return state_->opened; }
const Endpoint& Link::endpoint() const { return state_->endpoint; }

}  // namespace fathom::link

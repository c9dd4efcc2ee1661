#include "processes/board/http.hpp"

#include <arpa/inet.h>
#include <httplib.h>
#include <poll.h>
#include <strings.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <iterator>
#include <utility>

#include "common/board/page.hpp"
#include "common/runtime/self.hpp"
#include "processes/board/listener.hpp"

namespace fathom::board {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{3};  // for request and answer together
constexpr std::size_t kMostBytes = 16'384;    // of a request; browsers send less than one thousand
constexpr std::size_t kMostClients =
    512;                     // at a time, half of the descriptors that a process has: then the oldest goes
constexpr int kSlice = 100;  // ms between two looks at the clock

/// One request that is whole, and the answer to it: the library reads and writes memory and never waits.
class Exchange : public httplib::Stream {
 public:
  Exchange(const std::string& request, std::string from) : request_{request}, from_{std::move(from)} {}
  std::string answer;

  [[nodiscard]] bool is_readable() const override { return read_ < request_.size(); }
  [[nodiscard]] bool is_writable() const override { return true; }
  ssize_t read(char* to, std::size_t size) override {
    const std::size_t given = std::min(size, request_.size() - read_);
    std::memcpy(to, request_.data() + read_, given);
    read_ += given;
    return static_cast<ssize_t>(given);
  }
  ssize_t write(const char* from, std::size_t size) override {
    answer.append(from, size);
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = from_;
    port = 0;
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    ip.clear();
    port = 0;
  }
  [[nodiscard]] socket_t socket() const override { return -1; }

 private:
  const std::string& request_;
  std::string from_;
  std::size_t read_{};
};

/// "topside:8077" without the port, "[::1]:8077" without brackets.
std::string host_of(const std::string& header) {
  if (header.starts_with('[')) return header.substr(1, header.find(']') - 1);
  return header.substr(0, header.find(':'));
}

bool is_address(const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> unused{};
  return inet_pton(AF_INET, text.c_str(), unused.data()) == 1 || inet_pton(AF_INET6, text.c_str(), unused.data()) == 1;
}

std::string address_of(const sockaddr_storage& from) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const void* address = from.ss_family == AF_INET6
                            ? static_cast<const void*>(&reinterpret_cast<const sockaddr_in6*>(&from)->sin6_addr)
                            : static_cast<const void*>(&reinterpret_cast<const sockaddr_in*>(&from)->sin_addr);
  const char* known = inet_ntop(from.ss_family, address, text.data(), text.size());
  return known == nullptr ? "" : known;
}

/// This host itself, and whoever comes to it by a tunnel that has asked who he is (ssh -L).
bool is_here(const std::string& address) {
  return address.starts_with("127.") || address == "::1" || address.starts_with("::ffff:127.");
}

/// Why an order on the page's way is none; empty: it is one. A page of another origin cannot set this header without
/// asking first, which nobody answers, and the browser says by itself from where it comes.
std::string objection(const httplib::Request& request) {
  const std::string origin = request.get_header_value("Origin"), host = request.get_header_value("Host");
  if (request.get_header_value("X-Fathom") != "abort" || (!origin.empty() && origin != "http://" + host))
    return "an abort is asked for by this board's own page\n";
  if (is_here(request.remote_addr)) return {};
  return "ABORT works on the board's own host and through a tunnel that knows who you are: ssh -L 8077:localhost:8077 "
         "HOST, then http://localhost:8077/. On any host of the bus: fathom abort\n";
}

}  // namespace

class Server::Http : public httplib::Server {
 public:
  explicit Http(std::vector<std::string> names) : names_{std::move(names)} {
    for (const std::string& each : {std::string{"localhost"}, runtime::host_name(), runtime::host_name() + ".local"})
      names_.push_back(each);
  }

  // One request each. Ranges and compression are left aside: a request for a thousand ranges would be answered with a
  // thousand copies, and loopback needs no compression.
  [[nodiscard]] std::string answer(const std::string& request, const std::string& from) {
    Exchange exchange{request, from};
    bool closed = false;
    process_request(exchange, true, closed, [](httplib::Request& each) {
      each.ranges.clear();
      each.headers.erase("Accept-Encoding");
    });
    return std::move(exchange.answer);
  }

  // A page of the wide world can have its own name point to this host, and would then be allowed by the browser to read
  // what is shown here. What it cannot do is call this host by an address, or by this host's name.
  [[nodiscard]] bool is_called(const std::string& header) const {
    const std::string host = host_of(header);
    return is_address(host) || std::ranges::any_of(names_, [&](const std::string& each) {
             return strcasecmp(each.c_str(), host.c_str()) == 0;
           });
  }

 private:
  std::vector<std::string> names_;
};

struct Server::Client {
  int socket{};
  std::string from;  ///< its address
  Clock::time_point begin{Clock::now()};
  std::string request{}, answer{};
  std::size_t sent{};
  bool answered{false}, done{false};  ///< done: all was sent; the client's end is waited for

  Client(int descriptor, std::string address) : socket{descriptor}, from{std::move(address)} {}
  ~Client() { ::close(socket); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
};

Server::Server(const std::string& host, int port, const std::vector<std::string>& names, bool aborting)
    : http_{std::make_unique<Http>(names)}, port_{port}, json_{std::make_shared<const std::string>("{}")} {
  http_->set_payload_max_length(kMostBytes);
  // Should a name from the bus ever get into the page as a script, the browser would not run it.
  http_->set_default_headers({{"Content-Security-Policy", "default-src 'self'; img-src data:; frame-ancestors 'none'"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Cache-Control", "no-store"}});
  http_->set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    if (http_->is_called(request.get_header_value("Host"))) return httplib::Server::HandlerResponse::Unhandled;
    response.status = 421;  // misdirected
    response.set_content("this board does not go by that name; call it by an address, or start it with --name\n",
                         "text/plain");
    return httplib::Server::HandlerResponse::Handled;
  });
  const auto give = [&](const char* path, std::string_view text, const char* type) {
    http_->Get(path, [text, type](const httplib::Request&, httplib::Response& response) {
      response.set_content(text.data(), text.size(), type);
    });
  };
  give("/", kPage, "text/html; charset=utf-8");
  give("/style.css", kStyle, "text/css; charset=utf-8");
  give("/script.js", kScript, "text/javascript; charset=utf-8");
  give("/drawing.js", kDrawing, "text/javascript; charset=utf-8");
  http_->Get("/board.json", [this](const httplib::Request&, httplib::Response& response) {
    response.set_content(*shown(), "application/json");
  });
  http_->Post("/abort", [this, aborting](const httplib::Request& request, httplib::Response& response) {
    const std::string why = aborting ? objection(request) : "a log is played here: there is nothing to abort\n";
    if (why.empty()) {
      const std::uint64_t one = 1;
      (void)!::write(aborts_, &one, sizeof one);
    }
    response.status = why.empty() ? 202 : 403;
    response.set_content(why.empty() ? "asked; the page tells what becomes of it\n" : why, "text/plain");
  });
  http_->set_error_handler([](const httplib::Request&, httplib::Response& response) {
    if (response.status == 404) response.set_content("there is / and /board.json\n", "text/plain");
  });
  listener_ = listen_at(host, port_);
  wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  aborts_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  sigset_t all, before;  // signals are for the thread that waits for them
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread{[this] { serve(); }};
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Server::~Server() {
  const std::uint64_t one = 1;
  (void)!::write(wake_, &one, sizeof one);
  thread_.join();
  ::close(listener_);
  ::close(wake_);
  ::close(aborts_);
}

bool Server::taken() const {
  std::uint64_t count = 0;
  return ::read(aborts_, &count, sizeof count) == sizeof count && count > 0;
}

void Server::accept_clients() {
  for (;;) {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    const int socket = ::accept4(listener_, reinterpret_cast<sockaddr*>(&from), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket < 0) return;
    if (clients_.size() >= kMostClients) clients_.pop_front();
    clients_.emplace_back(socket, address_of(from));
  }
}

bool Server::attend(Client& client, short events) {
  if ((events & (POLLERR | POLLNVAL)) != 0) return false;
  if (!client.answered && (events & (POLLIN | POLLHUP)) != 0) {
    std::array<char, 4096> buffer{};
    const ssize_t count = ::recv(client.socket, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return false;
    if (count > 0) client.request.append(buffer.data(), static_cast<std::size_t>(count));
    if (client.request.find("\r\n\r\n") == std::string::npos) return client.request.size() <= kMostBytes;
    client.answer = http_->answer(client.request, client.from);
    client.answered = true;
    events |= POLLOUT;
  }
  if (client.answered && !client.done && (events & POLLOUT) != 0) {
    const ssize_t count = ::send(client.socket, client.answer.data() + client.sent, client.answer.size() - client.sent,
                                 MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    client.sent += static_cast<std::size_t>(count);
    if (client.sent < client.answer.size()) return true;
    client.done = true;
    ::shutdown(client.socket, SHUT_WR);
  }
  if (client.done && (events & (POLLIN | POLLHUP)) != 0) {  // to close before it has read all would take it away
    std::array<char, 4096> rest{};
    const ssize_t count = ::recv(client.socket, rest.data(), rest.size(), MSG_DONTWAIT);
    return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
  }
  return true;
}

void Server::serve() {
  std::vector<pollfd> watched;
  for (;;) {
    watched = {{.fd = wake_, .events = POLLIN, .revents = 0}, {.fd = listener_, .events = POLLIN, .revents = 0}};
    for (const Client& each : clients_) {
      const auto wanted = static_cast<short>(each.answered && !each.done ? POLLOUT : POLLIN);
      watched.push_back({.fd = each.socket, .events = wanted, .revents = 0});
    }
    ::poll(watched.data(), watched.size(), clients_.empty() ? -1 : kSlice);
    if (watched[0].revents != 0) break;
    const auto now = Clock::now();
    auto seen = std::next(watched.begin(), 2);
    for (auto each = clients_.begin(); each != clients_.end(); ++seen) {
      const bool late = now - each->begin > kPatience;
      each = !late && (seen->revents == 0 || attend(*each, seen->revents)) ? std::next(each) : clients_.erase(each);
    }
    if (watched[1].revents != 0) accept_clients();
  }
  clients_.clear();
}

void Server::show(std::string json) {
  auto text = std::make_shared<const std::string>(std::move(json));
  const std::lock_guard lock{mutex_};
  json_.swap(text);
}

std::shared_ptr<const std::string> Server::shown() const {
  const std::lock_guard lock{mutex_};
  return json_;
}

}  // namespace fathom::board

#include "processes/board/http.hpp"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "common/base/error.hpp"
#include "common/board/page.hpp"
#include "processes/board/connection.hpp"

namespace fathom::board {
namespace {

constexpr std::size_t kThreads = 32;
constexpr int kMostWaiting = 64;  // connections beside them; more are closed at once

// The library's own set SO_REUSEPORT, by which two boards would share one port, each with half of the clients.
void socket_options(socket_t socket) {
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

/// Why this place cannot be listened at; the library only says that.
std::string objection(const std::string& host, int port) {
  const std::string number = std::to_string(port);
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_PASSIVE;
  addrinfo* found = nullptr;
  if (const int code = getaddrinfo(host.c_str(), number.c_str(), &wanted, &found); code != 0)
    return "--host " + host + " is not known (" + gai_strerror(code) +
           "); give an address of this host, 127.0.0.1 for this host alone or 0.0.0.0 for all its networks";
  int why = EADDRNOTAVAIL;
  for (const addrinfo* each = found; each != nullptr && why != 0; each = each->ai_next) {
    const int socket = ::socket(each->ai_family, each->ai_socktype | SOCK_CLOEXEC, each->ai_protocol);
    if (socket < 0) continue;
    socket_options(socket);
    why = ::bind(socket, each->ai_addr, each->ai_addrlen) == 0 && ::listen(socket, 1) == 0 ? 0 : errno;
    ::close(socket);
  }
  freeaddrinfo(found);
  switch (why) {
    case 0:
      return {};
    case EADDRINUSE:
      return "--port " + number + ": another program listens at " + host + ":" + number +
             " (perhaps a second board); stop it or choose another port";
    case EACCES:
      return "--port " + number + ": ports below 1024 need permission; choose one above, such as 8077";
    case EADDRNOTAVAIL:
      return "--host " + host + " is no address of this host (ip address lists them); 127.0.0.1 is this host alone";
    default:
      return "cannot listen at " + host + ":" + number + ": " + std::strerror(why);
  }
}

// Set where a client is only to be told to go.
thread_local bool full = false;

/// So many wait for a thread and no more: each holds a descriptor.
class Queue : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> task) override {
    if (waiting_ >= kMostWaiting) {
      full = true;
      task();
      full = false;
      return;
    }
    ++waiting_;
    pool_.enqueue([this, task = std::move(task)] {
      --waiting_;
      task();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  httplib::ThreadPool pool_{kThreads};
  std::atomic<int> waiting_{0};
};

}  // namespace

class Server::Http : public httplib::Server {
 public:
  std::atomic<bool> leaving{false};

 private:
  // One request each. Ranges and compression are left aside: a request for a thousand ranges would be answered with a
  // thousand copies, and loopback needs no compression.
  bool process_and_close_socket(socket_t socket) override {
    if (!full) {
      Connection connection{socket, leaving};
      bool closed = false;
      process_request(connection, true, closed, [](httplib::Request& request) {
        request.ranges.clear();
        request.headers.erase("Accept-Encoding");
      });
    }
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return true;
  }
};

Server::Server(const std::string& host, int port)
    : http_{std::make_unique<Http>()}, json_{std::make_shared<const std::string>("{}")} {
  if (const std::string why = objection(host, port); !why.empty()) throw InputError(why);
  http_->set_socket_options(socket_options);
  http_->new_task_queue = [] { return new Queue; };
  http_->set_payload_max_length(Connection::kMostBytes);
  // Should a name from the bus ever get into the page as a script, the browser would not run it.
  http_->set_default_headers({{"Content-Security-Policy", "default-src 'self'; img-src data:; frame-ancestors 'none'"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Cache-Control", "no-store"}});
  const auto give = [&](const char* path, std::string_view text, const char* type) {
    http_->Get(path, [text, type](const httplib::Request&, httplib::Response& response) {
      response.set_content(text.data(), text.size(), type);
    });
  };
  give("/", kPage, "text/html; charset=utf-8");
  give("/style.css", kStyle, "text/css; charset=utf-8");
  give("/script.js", kScript, "text/javascript; charset=utf-8");
  http_->Get("/board.json", [this](const httplib::Request&, httplib::Response& response) {
    response.set_content(*shown(), "application/json");
  });
  http_->set_error_handler([](const httplib::Request&, httplib::Response& response) {
    if (response.status == 404) response.set_content("there is / and /board.json\n", "text/plain");
  });
  port_ = port;
  if (port == 0) {
    port_ = http_->bind_to_any_port(host);
  } else if (!http_->bind_to_port(host, port)) {
    port_ = -1;
  }
  if (port_ < 0) throw InputError("cannot listen at " + host + ":" + std::to_string(port));
  thread_ = std::thread{[this] { http_->listen_after_bind(); }};
  while (!http_->is_running()) std::this_thread::sleep_for(std::chrono::milliseconds{1});  // stop() would be lost
}

Server::~Server() {
  http_->leaving = true;
  http_->stop();
  thread_.join();
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

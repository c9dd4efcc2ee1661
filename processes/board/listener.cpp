#include "processes/board/listener.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/base/error.hpp"

namespace fathom::board {
namespace {

constexpr int kBacklog = 128;  // connections that the kernel keeps until they are accepted

std::string objection(const std::string& host, const std::string& number, int why) {
  switch (why) {
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

int port_of(int socket) {
  sockaddr_storage here{};
  socklen_t size = sizeof here;
  getsockname(socket, reinterpret_cast<sockaddr*>(&here), &size);
  return here.ss_family == AF_INET6 ? ntohs(reinterpret_cast<const sockaddr_in6*>(&here)->sin6_port)
                                    : ntohs(reinterpret_cast<const sockaddr_in*>(&here)->sin_port);
}

}  // namespace

int listen_at(const std::string& host, int& port) {
  const std::string number = std::to_string(port);
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_PASSIVE;
  addrinfo* found = nullptr;
  if (const int code = getaddrinfo(host.c_str(), number.c_str(), &wanted, &found); code != 0) {
    throw InputError("--host " + host + " is not known (" + gai_strerror(code) +
                     "); give an address of this host, 127.0.0.1 for this host alone or 0.0.0.0 for all its networks");
  }
  int why = EADDRNOTAVAIL, listener = -1;
  for (const addrinfo* each = found; each != nullptr && listener < 0; each = each->ai_next) {
    const int socket = ::socket(each->ai_family, each->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, each->ai_protocol);
    if (socket < 0) continue;
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (::bind(socket, each->ai_addr, each->ai_addrlen) == 0 && ::listen(socket, kBacklog) == 0) {
      listener = socket;
    } else {
      why = errno;
      ::close(socket);
    }
  }
  freeaddrinfo(found);
  if (listener < 0) throw InputError(objection(host, number, why));
  port = port_of(listener);
  return listener;
}

}  // namespace fathom::board

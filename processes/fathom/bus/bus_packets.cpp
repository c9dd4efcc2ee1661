#include "processes/fathom/bus/bus_packets.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>

#include "common/base/error.hpp"

namespace fathom::tool {
namespace {

double steady() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Packets that the kernel has thrown away because a listener on this host had no room for them.
std::int64_t thrown_away() {
  std::ifstream file{"/proc/net/snmp"};
  std::string names, values, name;
  while (std::getline(file, names) && std::getline(file, values)) {
    std::istringstream words{names}, numbers{values};
    std::int64_t number{};
    std::string first;
    if (!(words >> name) || name != "Udp:") continue;
    for (numbers >> first; words >> name && numbers >> number;) {
      if (name == "RcvbufErrors") return number;
    }
  }
  return 0;
}

/// Bytes that wait in the fullest socket of this port.
std::int64_t fullest(int port) {
  std::ifstream file{"/proc/net/udp"};
  std::string line;
  std::int64_t most = 0;
  while (std::getline(file, line)) {
    unsigned local{}, waiting{};
    if (std::sscanf(line.c_str(), " %*d: %*8x:%x %*8x:%*x %*x %*x:%x", &local, &waiting) != 2) continue;
    if (local == static_cast<unsigned>(port)) most = std::max(most, static_cast<std::int64_t>(waiting));
  }
  return most;
}

}  // namespace

BusPackets::BusPackets(const std::string& url) {
  char address[64] = "239.255.76.67";
  port_ = 7667;
  std::sscanf(url.c_str(), "udpm://%63[0-9.]:%d", address, &port_);
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int yes = 1, room = 4'194'304;
  setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
  setsockopt(socket_, SOL_SOCKET, SO_RXQ_OVFL, &yes, sizeof yes);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_port = htons(static_cast<std::uint16_t>(port_));
  ip_mreq group{};
  inet_pton(AF_INET, address, &group.imr_multiaddr);
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof here) != 0 ||
      setsockopt(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0) {
    throw InputError(url + ": cannot listen; fathom doctor tells why");
  }
  kernel_losses_ = thrown_away();
}

BusPackets::~BusPackets() {
  if (socket_ >= 0) close(socket_);
}

void BusPackets::read() {
  std::array<std::uint8_t, 65'536> buffer{};
  std::array<char, 64> extra{};
  sockaddr_in sender{};
  for (int i = 0; i < 4096; ++i) {
    iovec part{.iov_base = buffer.data(), .iov_len = buffer.size()};
    msghdr message{};
    message.msg_name = &sender;
    message.msg_namelen = sizeof sender;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = extra.data();
    message.msg_controllen = extra.size();
    const ssize_t length = recvmsg(socket_, &message, 0);
    if (length < 0) break;
    for (cmsghdr* each = CMSG_FIRSTHDR(&message); each != nullptr; each = CMSG_NXTHDR(&message, each)) {
      if (each->cmsg_type == SO_RXQ_OVFL) std::memcpy(&own_losses_, CMSG_DATA(each), sizeof own_losses_);
    }
    const std::uint64_t who = static_cast<std::uint64_t>(sender.sin_addr.s_addr) << 16U | sender.sin_port;
    watch_.hear(who, {buffer.data(), static_cast<std::size_t>(length)});
  }
  if (steady() < next_look_) return;
  next_look_ = steady() + 0.5;
  longest_queue_ = std::max(longest_queue_, fullest(port_));
}

void BusPackets::report(double seconds) const {
  std::printf("%lld messages in %.0f s (%.0f a second) from %zu senders; by their numbers %lld lost, %lld incomplete\n",
              static_cast<long long>(watch_.messages()), seconds, static_cast<double>(watch_.messages()) / seconds,
              watch_.senders(), static_cast<long long>(watch_.lost()), static_cast<long long>(watch_.incomplete()));
  if (own_losses_ > 0) std::printf("(this listener itself had no room for %u packets)\n", own_losses_);
  std::printf("packets that any listener of this host had no room for: %lld; most that waited in one socket: %lld kB\n",
              static_cast<long long>(thrown_away() - kernel_losses_), static_cast<long long>(longest_queue_ / 1000));
}

}  // namespace fathom::tool

// A bad cable for tests: carries Ethernet frames between two network interfaces, both ways, at a limited rate, with a
// queue that overflows, and loses some by chance; SIGUSR1 cuts it, SIGUSR2 mends it. usage: test_cable A B BITS_PER_S
// LOSS
#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <poll.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <random>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using Frame = std::vector<std::uint8_t>;

constexpr std::size_t kLargestQueue = 65'536;  // B: a quarter of a second at 2 Mbit/s

int open_interface(const char* name) {
  const int socket = ::socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK, htons(ETH_P_ALL));
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_ALL);
  address.sll_ifindex = static_cast<int>(if_nametoindex(name));
  const int large = 4'194'304;
  setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &large, sizeof large);
  if (address.sll_ifindex == 0 || bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    std::perror(name);
    std::exit(1);
  }
  return socket;
}

// Checksums are left to an interface that a veth pair has not: none at all is allowed over IPv4.
void drop_checksum(Frame& frame) {
  constexpr std::size_t kIp = 14;
  if (frame.size() < kIp + 28 || frame[12] != 0x08 || frame[13] != 0x00 || frame[kIp + 9] != 17) return;
  const bool fragment = (frame[kIp + 6] & 0x3FU) != 0 || frame[kIp + 7] != 0;
  const std::size_t udp = kIp + 4U * (frame[kIp] & 0x0FU);
  if (!fragment && frame.size() >= udp + 8) frame[udp + 6] = frame[udp + 7] = 0;
}

struct Way {
  int from{}, to{};
  std::deque<Frame> queue{};
  std::size_t waiting{};  // B
  Clock::time_point free{};
  long carried{}, lost{}, overflown{};

  void read(bool cut, double loss, std::mt19937& random) {
    std::array<std::uint8_t, 4096> buffer{};
    sockaddr_ll sender{};
    socklen_t size = sizeof sender;
    ssize_t length{};
    while ((length = recvfrom(from, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&sender), &size)) >
           0) {
      if (sender.sll_pkttype == PACKET_OUTGOING) continue;
      if (cut || std::uniform_real_distribution<>{}(random) < loss) {
        ++lost;
        continue;
      }
      if (waiting + static_cast<std::size_t>(length) > kLargestQueue) {
        ++overflown;
        continue;
      }
      waiting += static_cast<std::size_t>(length);
      queue.emplace_back(buffer.begin(), buffer.begin() + length);
    }
  }
  void write(double rate) {
    while (!queue.empty() && Clock::now() >= free) {
      Frame& frame = queue.front();
      drop_checksum(frame);
      if (send(to, frame.data(), frame.size(), 0) > 0) ++carried;
      const std::chrono::duration<double> takes{8.0 * static_cast<double>(frame.size()) / rate};
      free = std::max(free, Clock::now()) + std::chrono::duration_cast<Clock::duration>(takes);
      waiting -= frame.size();
      queue.pop_front();
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  sigset_t heard;
  sigemptyset(&heard);
  for (const int each : {SIGUSR1, SIGUSR2, SIGINT, SIGTERM}) sigaddset(&heard, each);
  sigprocmask(SIG_BLOCK, &heard, nullptr);
  const int signals = signalfd(-1, &heard, SFD_NONBLOCK);
  const int a = open_interface(argv[1]), b = open_interface(argv[2]);
  const double rate = std::atof(argv[3]), loss = std::atof(argv[4]);
  std::array ways{Way{.from = a, .to = b}, Way{.from = b, .to = a}};
  std::mt19937 random{4};
  for (bool cut = false, ends = false; !ends;) {
    std::array<pollfd, 3> watched{{{.fd = signals, .events = POLLIN, .revents = 0},
                                   {.fd = a, .events = POLLIN, .revents = 0},
                                   {.fd = b, .events = POLLIN, .revents = 0}}};
    const bool busy = !ways[0].queue.empty() || !ways[1].queue.empty();
    poll(watched.data(), watched.size(), busy ? 1 : 1000);
    signalfd_siginfo info;
    while (read(signals, &info, sizeof info) == static_cast<ssize_t>(sizeof info)) {
      if (info.ssi_signo == SIGUSR1) cut = true;
      if (info.ssi_signo == SIGUSR2) cut = false;
      ends = ends || info.ssi_signo == SIGINT || info.ssi_signo == SIGTERM;
    }
    for (Way& way : ways) {
      if (cut) way.waiting = (way.queue.clear(), 0);
      way.read(cut, loss, random);
      way.write(rate);
    }
  }
  for (const Way& way : ways) {
    std::printf("carried %ld, lost %ld, overflown %ld\n", way.carried, way.lost, way.overflown);
  }
  return 0;
}

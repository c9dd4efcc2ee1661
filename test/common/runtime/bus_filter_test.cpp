// The filter at a bus's socket: what is heard arrives, what nobody asked for does not, what was sent past the bus does
// not either, and nothing is lost by it.
#include "common/runtime/bus_filter.hpp"

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <fathom_lcm/depth_t.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/runtime/bus.hpp"

namespace fathom::runtime {
namespace {

using namespace std::chrono_literals;

class Socket {
 public:
  Socket() : descriptor_{socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)} {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(bind(descriptor_, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0);
  }
  ~Socket() { close(descriptor_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }

  void send_to(const Socket& other, const std::string& bytes) const {
    sockaddr_in there{};
    socklen_t size = sizeof there;
    REQUIRE(getsockname(other.descriptor_, reinterpret_cast<sockaddr*>(&there), &size) == 0);
    REQUIRE(sendto(descriptor_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&there), size) > 0);
  }

  /// What lies there; over loopback a packet is there when its sending returns.
  [[nodiscard]] std::optional<std::string> next() const {
    std::string bytes(1000, '\0');
    const ssize_t length = recv(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (length < 0) return {};
    bytes.resize(static_cast<std::size_t>(length));
    return bytes;
  }

 private:
  int descriptor_;
};

std::string message(const std::string& channel, const std::string& data, const std::string& magic = "LC02") {
  return magic + std::string("\0\0\0\7", 4) + channel + std::string(1, '\0') + data;
}

}  // namespace

TEST_CASE("channel filter: passes the channels asked for, whole names alone") {
  Socket from, to;
  REQUIRE(filter(to.descriptor(), channel_program(std::vector<std::string>{"STATE", "STATE_OF_ALL", "DVL"})));
  const std::string data = "12345678";
  for (const char* heard : {"STATE", "STATE_OF_ALL", "DVL"}) {
    from.send_to(to, message(heard, data));
    CHECK(to.next() == message(heard, data));
    from.send_to(to, message(heard, ""));  // nothing behind the name
    CHECK(to.next() == message(heard, ""));
  }
  for (const char* other : {"STAT", "STATE_", "STATES", "state", "DV", "DVL2", "", "AHRS", "LOCKSTEP_ACK"}) {
    CAPTURE(other);
    from.send_to(to, message(other, data));
    CHECK_FALSE(to.next());
    from.send_to(to, message(other, ""));
    CHECK_FALSE(to.next());
  }
}

TEST_CASE("channel filter: leaves alone what it cannot judge") {
  Socket from, to;
  REQUIRE(filter(to.descriptor(), channel_program(std::vector<std::string>{"STATE"})));
  const std::string part = message("CAMERA", "12345678", "LC03");  // only the first of several names its channel
  from.send_to(to, part);
  CHECK(to.next() == part);
  from.send_to(to, "no LCM at all");
  CHECK(to.next() == "no LCM at all");
}

namespace {

std::string number(std::uint32_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> (8 * i));
  return text;
}

/// Part `index` of two of a message of 1000 bytes, as LCM writes it.
std::string part(std::uint32_t index, std::uint32_t offset, const std::string& rest) {
  return "LC03" + number(7, 4) + number(1000, 4) + number(offset, 4) + number(index, 2) + number(2, 2) + rest;
}

std::string named(const std::string& channel) { return channel + std::string(1, '\0'); }

}  // namespace

TEST_CASE("bus filter: what liblcm would follow beyond a packet or a message does not reach it") {
  const BusAddress here{.group = 0x7f000001, .port = 1, .one_host = true};
  for (const std::vector<std::string>& channels : {std::vector<std::string>{}, std::vector<std::string>{"DEPTH"}}) {
    CAPTURE(channels.size());
    Socket from, to;
    REQUIRE(filter(to.descriptor(), bus_program(here, channels)));
    const std::string data(500, 'x'), longest(63, 'A');
    for (const std::string& good : {part(0, 0, named("DEPTH") + data), part(0, 0, named(longest) + data),
                                    part(1, 500, data), part(1, 1U << 28U, data), message("DEPTH", "")}) {
      from.send_to(to, good);
      CHECK(to.next() == good);
    }
    for (const std::string& bad :
         {part(1, 0xffffff00, data), part(0, 0xffffff00, named("DEPTH") + data), part(1, (1U << 28U) + 1, data),
          part(0, 0, data), part(0, 0, "DEPTH"), part(0, 0, ""), part(0, 0, named(longest + "A") + data),
          part(1, 0, "").substr(0, 19), part(1, 0, "").substr(0, 8), message("DEPTH", "").substr(0, 13),
          message("", "").substr(0, 8)}) {
      CAPTURE(bad.size());
      from.send_to(to, bad);
      CHECK_FALSE(to.next());
    }
  }
}

TEST_CASE("channel filter: too many channels are not filtered") {
  std::vector<std::string> channels(60, std::string(60, 'A'));
  CHECK(channel_program(channels).empty());
  channels.resize(20);
  CHECK_FALSE(channel_program(channels).empty());
}

namespace {

Url own_bus() {
  return Url::parse("udpm://239.255.76.67:" + std::to_string(20000 + getpid() % 20000) + "?ttl=0&recv_buf_size=2097152",
                    "--in");
}

/// Channels that come within a second, or until there are so many.
std::vector<std::string> heard(LiveInput& input, std::size_t most) {
  std::vector<std::string> all;
  const auto last = std::chrono::steady_clock::now() + 1s;
  while (all.size() < most && std::chrono::steady_clock::now() < last) {
    input.wait(-1, 50);
    while (const auto each = input.next()) all.push_back(each->channel);
  }
  return all;
}

}  // namespace

TEST_CASE("bus filter: reads group, port and ttl as liblcm does") {
  const auto is = [](const char* url, std::uint32_t group, int port, bool one_host) {
    CAPTURE(url);
    const BusAddress bus = BusAddress::of(url);
    CHECK(bus.group == group);
    CHECK(bus.port == port);
    CHECK(bus.one_host == one_host);
  };
  constexpr std::uint32_t kLcm = 0xefff4c43, kOther = 0xefff4c44;  // 239.255.76.67, .68
  is("udpm://239.255.76.68:7668?ttl=1", kOther, 7668, false);
  is("udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152", kLcm, 7667, true);
  is("udpm://239.255.76.67:7667?recv_buf_size=2097152&ttl=2", kLcm, 7667, false);
  is("udpm://", kLcm, 7667, true);
  is("udpm://?recv_buf_size=2097152", kLcm, 7667, true);
  is("udpm://239.255.76.67:7667", kLcm, 7667, true);  // liblcm's own choice
}

TEST_CASE("bus filter: a part of a message that belongs 4 GB behind it kills no listener") {
  const Url url = own_bus();
  LiveInput input{{url}, {{"DEPTH", 100}}};
  const BusAddress bus = BusAddress::of(url.text);
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in there{};
  there.sin_family = AF_INET;
  there.sin_port = htons(bus.port);
  there.sin_addr.s_addr = htonl(bus.group);
  // The second one is written only into what the first has begun.
  for (const std::string& each : {part(0, 0, named("DEPTH") + std::string(500, 'x')),
                                  part(1, 0xffffff00, std::string(500, 'x')), message("DEPTH", "12345678")}) {
    CHECK(sendto(socket, each.data(), each.size(), 0, reinterpret_cast<const sockaddr*>(&there), sizeof there) > 0);
  }
  CHECK(heard(input, 1).size() == 1);
  close(socket);
}

TEST_CASE("bus filter: what is sent to this host past the bus is not believed, for one channel or for all") {
  for (const char* channels : {"DEPTH", ".*"}) {
    CAPTURE(channels);
    const Url url = own_bus();
    LiveInput input{{url}, {{channels, 100}}};
    const std::string bytes = message("DEPTH", "12345678");
    const auto send = [&](const char* address) {
      const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
      sockaddr_in there{};
      there.sin_family = AF_INET;
      there.sin_port = htons(BusAddress::of(url.text).port);
      inet_pton(AF_INET, address, &there.sin_addr);
      const auto* to = reinterpret_cast<const sockaddr*>(&there);
      REQUIRE(sendto(socket, bytes.data(), bytes.size(), 0, to, sizeof there) == static_cast<ssize_t>(bytes.size()));
      close(socket);
    };
    for (int i = 0; i < 5; ++i) send("127.0.0.1");
    send("239.255.76.67");  // queued behind them
    CHECK(heard(input, 2).size() == 1);
  }
}

TEST_CASE("channel filter: a process hears its own channels of a live bus, and is not woken for others") {
  const Url url = own_bus();
  const BusAddress bus = BusAddress::of(url.text);
  const auto before = listening_sockets(bus.port);
  LiveInput input{{url}, {{"DEPTH", 10}, {"AHRS", 10}}};
  Output output{url};
  for (const char* channel : {"STATE", "DEPTH", "TRUTH", "AHRS"}) {
    fathom_lcm::depth_t depth{};
    say(output, channel, depth);
  }
  std::vector<std::size_t> heard;
  const auto last = std::chrono::steady_clock::now() + 5s;
  while (heard.size() < 2 && std::chrono::steady_clock::now() < last) {
    input.wait(-1, 50);
    while (const auto each = input.next()) heard.push_back(each->subscription);
  }
  CHECK(heard == std::vector<std::size_t>{0, 1});
  const auto after = listening_sockets(bus.port);
  REQUIRE(after.size() == before.size() + 1);
  const auto socket =
      std::ranges::find_if(after, [&](int each) { return std::ranges::find(before, each) == before.end(); });
  REQUIRE(socket != after.end());
  socklen_t instructions = 0;  // asked like this, the kernel tells how many there are
  if (getsockopt(*socket, SOL_SOCKET, SO_GET_FILTER, nullptr, &instructions) != 0) {
    // Emulators of other processors do not hand this question on.
    CHECK((errno == ENOPROTOOPT || errno == EINVAL));
    return;
  }
  CHECK(instructions == bus_program(bus, std::vector<std::string>{"DEPTH", "AHRS"}).size());
}

}  // namespace fathom::runtime

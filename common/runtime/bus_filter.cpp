#include "common/runtime/bus_filter.hpp"

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <random>
#include <system_error>

#include "common/base/error.hpp"

namespace fathom::runtime {
namespace {

// Of a UDP socket's packet the kernel shows the UDP header first. LCM's own: magic number, sequence number, and in a
// message of a single packet the channel, which a zero byte ends.
constexpr std::uint32_t kMagicAt = 8, kChannelAt = 16, kWhole = 0x4c433032;  // "LC02"
constexpr std::uint32_t kAll = 0xffffffff;
constexpr std::size_t kLongestName = 63;  // of an LCM channel; and a jump of BPF must reach beyond its comparison

// A message of several packets: in each where its part belongs, its number and how many there are; in the first the
// channel follows.
constexpr std::uint32_t kPart = 0x4c433033;  // "LC03"
constexpr std::uint32_t kOffsetAt = 20, kNumberAt = 24, kHeaderEndsAt = 27, kFirstChannelAt = 28;
constexpr std::uint32_t kLargest = 1U << 28U;  // B, of a message as liblcm takes it

// Beside the packet's bytes: its IP header (destination at byte 16) and what the kernel knows of it.
constexpr auto kDestinationAt = static_cast<std::uint32_t>(SKF_NET_OFF + 16);
constexpr auto kInterface = static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_IFINDEX);
constexpr auto kPacketType = static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_PKTTYPE);
constexpr std::uint32_t kLoopback = 1;  // Linux numbers lo first in every network namespace

// liblcm's own, which every listener already ignores.
constexpr char kSelfTest[] = "LCM_SELF_TEST";

struct Fence {
  std::array<char, 16> sign{};
  bool came{false};
};

void hear_fence(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/, Fence* fence) {
  const auto* data = static_cast<const char*>(buffer->data);
  fence->came = fence->came ||
                (buffer->data_size == fence->sign.size() && std::equal(fence->sign.begin(), fence->sign.end(), data));
}

/// Goes on behind itself where a name that begins there ends within the packet, and is not too long; else drops it.
std::vector<sock_filter> name_program(std::uint32_t at) {
  std::vector<sock_filter> program;
  for (std::size_t i = 0; i <= kLongestName; ++i) {
    const auto beyond = static_cast<std::uint8_t>(2 * (kLongestName - i) + 1);
    program.push_back(BPF_STMT(BPF_LD | BPF_B | BPF_ABS, at + static_cast<std::uint32_t>(i)));
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, beyond, 0));
  }
  program.push_back(BPF_STMT(BPF_RET | BPF_K, 0));
  return program;
}

/// Goes on behind `checks` with what does not begin so.
void append_for(std::uint32_t magic, const std::vector<sock_filter>& checks, std::vector<sock_filter>& program) {
  program.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kMagicAt));
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, magic, 0, static_cast<std::uint8_t>(checks.size())));
  program.insert(program.end(), checks.begin(), checks.end());
}

/// liblcm trusts a packet's form: it adds where a part belongs to its length in 32 bits, so that one from
/// the end of these 4 GB is written there; it takes the header's length from a packet that is shorter; and it looks for
/// the end of a channel's name behind the packet. What is read beyond a packet's end drops it.
void append_form(std::vector<sock_filter>& program) {
  const std::vector<sock_filter> first = name_program(kFirstChannelAt), whole = name_program(kChannelAt);
  std::vector<sock_filter> part{BPF_STMT(BPF_LD | BPF_B | BPF_ABS, kHeaderEndsAt),
                                BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kOffsetAt),
                                BPF_JUMP(BPF_JMP | BPF_JGT | BPF_K, kLargest, 0, 1),
                                BPF_STMT(BPF_RET | BPF_K, 0),
                                BPF_STMT(BPF_LD | BPF_H | BPF_ABS, kNumberAt),
                                BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 0, static_cast<std::uint8_t>(first.size()))};
  part.insert(part.end(), first.begin(), first.end());
  append_for(kPart, part, program);
  append_for(kWhole, whole, program);
}

}  // namespace

BusAddress BusAddress::of(const std::string& url) {
  BusAddress bus{.group = 0xefff4c43, .port = 7667, .one_host = true};  // 239.255.76.67
  constexpr std::size_t kScheme = 7;                                    // "udpm://"
  const auto options = std::min(url.find('?'), url.size());
  const std::string place = url.size() > kScheme ? url.substr(kScheme, options - kScheme) : "";
  const auto colon = std::min(place.find(':'), place.size());
  in_addr group{};
  if (inet_aton(place.substr(0, colon).c_str(), &group) != 0) bus.group = ntohl(group.s_addr);
  if (colon < place.size()) bus.port = static_cast<std::uint16_t>(std::strtol(place.c_str() + colon + 1, nullptr, 0));
  for (auto at = options; at < url.size();) {
    const auto end = std::min(url.find('&', at + 1), url.size());
    const std::string option = url.substr(at + 1, end - at - 1);
    if (option.starts_with("ttl="))
      bus.one_host = static_cast<std::uint8_t>(std::strtol(option.c_str() + 4, nullptr, 0)) == 0;
    at = end;
  }
  return bus;
}

// Byte by byte, so that nothing is read behind the zero byte of a shorter name: a read beyond a packet's end drops it.
std::vector<sock_filter> channel_program(std::span<const std::string> channels) {
  std::vector<sock_filter> program{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kMagicAt),
                                   BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kWhole, 1, 0), BPF_STMT(BPF_RET | BPF_K, kAll)};
  for (const std::string& channel : channels) {
    if (channel.size() > kLongestName) continue;
    const std::size_t bytes = channel.size() + 1;
    for (std::size_t i = 0; i < bytes; ++i) {
      const auto beyond = static_cast<std::uint8_t>(2 * (bytes - i - 1) + 1);
      program.push_back(BPF_STMT(BPF_LD | BPF_B | BPF_ABS, kChannelAt + static_cast<std::uint32_t>(i)));
      program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint8_t>(channel.c_str()[i]), 0, beyond));
    }
    program.push_back(BPF_STMT(BPF_RET | BPF_K, kAll));
  }
  program.push_back(BPF_STMT(BPF_RET | BPF_K, 0));
  if (program.size() > BPF_MAXINSNS) program.clear();
  return program;
}

// From this host is what comes over lo, and the copy that the kernel keeps of its own multicast on another interface
// (PACKET_LOOPBACK, which no packet from outside is ever given). A packet's own ttl proves nothing: its sender writes
// it.
std::vector<sock_filter> bus_program(const BusAddress& bus, std::span<const std::string> channels) {
  std::vector<sock_filter> program{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kDestinationAt),
                                   BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, bus.group, 1, 0), BPF_STMT(BPF_RET | BPF_K, 0)};
  if (bus.one_host) {
    program.insert(
        program.end(),
        {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kInterface), BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kLoopback, 3, 0),
         BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kPacketType), BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, PACKET_LOOPBACK, 1, 0),
         BPF_STMT(BPF_RET | BPF_K, 0)});
  }
  append_form(program);
  const std::vector<sock_filter> wanted = channels.empty() ? std::vector<sock_filter>{} : channel_program(channels);
  if (wanted.empty() || program.size() + wanted.size() > BPF_MAXINSNS) {
    program.push_back(BPF_STMT(BPF_RET | BPF_K, kAll));
  } else {
    program.insert(program.end(), wanted.begin(), wanted.end());
  }
  return program;
}

std::vector<int> listening_sockets(std::uint16_t port) {
  std::vector<int> found;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator{"/proc/self/fd", none}) {
    const std::string name = entry.path().filename();
    int descriptor = -1, type = 0, shared = 0;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    socklen_t size = sizeof(int);
    if (getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM) continue;
    if (getsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &shared, &size) != 0 || shared == 0) continue;
    sockaddr_in here{};
    size = sizeof here;
    if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&here), &size) != 0) continue;
    if (here.sin_family == AF_INET && ntohs(here.sin_port) == port) found.push_back(descriptor);
  }
  return found;
}

bool filter(int socket, std::vector<sock_filter> program) {
  const sock_fprog all{.len = static_cast<unsigned short>(program.size()), .filter = program.data()};
  return setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &all, sizeof all) == 0;
}

// liblcm opens its socket with the first subscription, does not show it, and reads from then on. Whatever had come by
// the time that the filter stands is read before our own message that is sent afterwards; nobody has subscribed to it.
std::optional<int> listen_filtered(lcm::LCM& bus, const std::string& url) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds kLongest{10};  // as liblcm waits for its own
  constexpr int kAgainMs = 100;
  const BusAddress address = BusAddress::of(url);
  const std::vector<int> before = listening_sockets(address.port);
  Fence fence;
  std::random_device chance;
  for (char& each : fence.sign) each = static_cast<char>(chance());
  auto* handle = bus.subscribeFunction(kSelfTest, &hear_fence, &fence);
  if (handle == nullptr) throw InputError(url + ": cannot listen; does multicast come back to this host?");
  std::vector<int> came = listening_sockets(address.port);
  std::erase_if(came, [&](int each) { return std::ranges::find(before, each) != before.end(); });
  const bool filtered = std::ranges::all_of(came, [&](int each) { return filter(each, bus_program(address, {})); });
  if (came.empty() || !filtered) {
    throw InputError(url +
                     ": this system cannot tell what was sent to the bus from what was sent to this host alone "
                     "(no socket filter), so that any host could give orders here");
  }
  for (const auto end = Clock::now() + kLongest; !fence.came && Clock::now() < end;) {
    bus.publish(kSelfTest, fence.sign.data(), static_cast<unsigned>(fence.sign.size()));
    const auto again = Clock::now() + std::chrono::milliseconds{kAgainMs};
    while (!fence.came && Clock::now() < again) bus.handleTimeout(kAgainMs);
  }
  bus.unsubscribe(handle);
  if (!fence.came) throw InputError(url + ": what is sent to the bus does not come back to this host");
  if (came.size() > 1) return {};
  return came.front();
}

}  // namespace fathom::runtime

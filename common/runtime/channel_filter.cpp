#include "common/runtime/channel_filter.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <system_error>

namespace fathom::runtime {
namespace {

// Of a UDP socket's packet the kernel shows the UDP header first. LCM's own: magic number, sequence number, and in a
// message of a single packet the channel, which a zero byte ends.
constexpr std::uint32_t kMagicAt = 8, kChannelAt = 16, kWhole = 0x4c433032;  // "LC02"
constexpr std::uint32_t kAll = 0xffffffff;
constexpr std::size_t kLongestName = 63;  // of an LCM channel; and a jump of BPF must reach beyond its comparison

}  // namespace

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

std::vector<int> listening_sockets() {
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
    if (here.sin_family == AF_INET && here.sin_port != 0) found.push_back(descriptor);
  }
  return found;
}

void hear_only(int socket, std::span<const std::string> channels) {
  std::vector<sock_filter> program = channel_program(channels);
  if (program.empty()) return;
  const sock_fprog all{.len = static_cast<unsigned short>(program.size()), .filter = program.data()};
  setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &all, sizeof all);  // refused: all is delivered, as without it
}

}  // namespace fathom::runtime

// Which packets of a bus reach a process at all. liblcm reads whatever comes to its port: from any host, sent to the
// bus's multicast address or to this host alone. A filter at the socket (classic BPF) has the kernel leave out what was
// not sent to the bus, what comes from another host where the bus does not leave this one, what liblcm would follow
// beyond its memory, and the channels that nobody here listens to, for each of which the process would be woken.
#pragma once

#include <linux/filter.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lcm {
class LCM;
}

namespace fathom::runtime {

/// What the URL of a live bus says of its packets, as liblcm reads it.
struct BusAddress {
  std::uint32_t group{};  ///< multicast address, host byte order
  std::uint16_t port{};
  bool one_host{};  ///< ttl 0, liblcm's own choice: no packet leaves its host, so none comes from another one
  [[nodiscard]] static BusAddress of(const std::string& url);
};

/// Classic BPF that passes what was sent to the bus, on one host alone what was sent by this host; then LCM messages of
/// these channels, sound parts of one that comes in several packets (only the first says of which channel it is), and
/// what is not LCM's. All channels where none is named, and where there are too many to compare.
[[nodiscard]] std::vector<sock_filter> bus_program(const BusAddress& bus, std::span<const std::string> channels);

/// The part of it that looks at channels; empty when there is too much to compare.
[[nodiscard]] std::vector<sock_filter> channel_program(std::span<const std::string> channels);

/// File descriptors of this process's UDP sockets that are bound to this port as others may be, too: a bus's listeners
/// share one, and whoever only speaks has one of his own.
[[nodiscard]] std::vector<int> listening_sockets(std::uint16_t port);

/// Only what passes reaches the socket from now on. False when the kernel cannot do it.
[[nodiscard]] bool filter(int socket, std::vector<sock_filter> program);

/// Makes the bus listen, with nobody subscribed, and have its socket filtered before anything is delivered: what came
/// before has been read and thrown away when this returns. Its socket, for a narrower filter; nothing where another
/// thread opened one meanwhile. InputError when the bus cannot be heard.
[[nodiscard]] std::optional<int> listen_filtered(lcm::LCM& bus, const std::string& url);

}  // namespace fathom::runtime

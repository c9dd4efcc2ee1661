// Which packets of a bus reach a process at all. Every LCM process on a host gets every packet of the bus, and liblcm
// wakes up for each to find that most are for others; a filter at the socket lets the kernel leave those out.
#pragma once

#include <linux/filter.h>

#include <span>
#include <string>
#include <vector>

namespace fathom::runtime {

/// Classic BPF that passes LCM messages of these channels, whatever comes in more than one packet (only the first says
/// of which channel it is), and what is not LCM's. Empty when there is too much to compare: then nothing is left out.
[[nodiscard]] std::vector<sock_filter> channel_program(std::span<const std::string> channels);

/// File descriptors of this process's UDP sockets that are bound to a port which others may be bound to as well: a
/// bus's listeners share one, and whoever only speaks has one of his own.
[[nodiscard]] std::vector<int> listening_sockets();

/// Only these channels reach the socket from now on. A kernel that cannot do it delivers all, as before.
void hear_only(int socket, std::span<const std::string> channels);

}  // namespace fathom::runtime

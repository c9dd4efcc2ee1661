// Hears the packets of a bus below liblcm, and what the kernel threw away for want of room.
#pragma once

#include <cstdint>
#include <string>

#include "common/runtime/bus.hpp"
#include "common/runtime/packet_watch.hpp"

namespace fathom::tool {

class BusPackets {
 public:
  /// InputError when the URL's multicast group cannot be joined.
  explicit BusPackets(const std::string& url);
  ~BusPackets();
  BusPackets(const BusPackets&) = delete;
  BusPackets& operator=(const BusPackets&) = delete;

  [[nodiscard]] int descriptor() const { return socket_; }
  void read();
  void report(double seconds) const;

 private:
  int port_{};
  int socket_{-1};
  runtime::PacketWatch watch_;
  std::uint32_t own_losses_{};    ///< packets that this listener had no room for
  std::int64_t kernel_losses_{};  ///< of all listeners on this host, before
  std::int64_t longest_queue_{};  ///< B that waited in one socket
  double next_look_{};
};

}  // namespace fathom::tool

// LCM's packets by their sequence numbers: how many messages of a bus never reached a listener. liblcm does not say.
#pragma once

#include <cstdint>
#include <map>
#include <span>

namespace fathom::runtime {

class PacketWatch {
 public:
  /// One UDP packet. `sender`: its address and port, of which every LCM instance has its own.
  void hear(std::uint64_t sender, std::span<const std::uint8_t> packet);

  [[nodiscard]] std::int64_t messages() const { return messages_; }
  /// Messages of which no packet came, and those of which some did not.
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  [[nodiscard]] std::int64_t incomplete() const { return incomplete_; }
  /// Packets that are not LCM's.
  [[nodiscard]] std::int64_t strange() const { return strange_; }
  [[nodiscard]] std::size_t senders() const { return senders_.size(); }

 private:
  static constexpr std::size_t kMostSenders = 10'000;  // that a hostile host may make up
  struct Sender {
    std::uint32_t number{};   ///< of the newest message
    std::uint32_t missing{};  ///< of its packets
  };
  std::map<std::uint64_t, Sender> senders_;
  std::int64_t messages_{}, lost_{}, incomplete_{}, strange_{};
};

}  // namespace fathom::runtime

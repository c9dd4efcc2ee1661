#include "common/runtime/packet_watch.hpp"

namespace fathom::runtime {
namespace {

constexpr std::uint32_t kWhole = 0x4c433032, kPart = 0x4c433033;  // "LC02", "LC03"
constexpr std::size_t kWholeHeader = 8, kPartHeader = 20;
constexpr std::uint32_t kJump = 1'000'000;  // a number that is farther off is a new sender's on an old one's port

std::uint32_t number_at(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8U | bytes[at + i];
  return value;
}

}  // namespace

void PacketWatch::hear(std::uint64_t sender, std::span<const std::uint8_t> packet) {
  const std::uint32_t magic = packet.size() >= kWholeHeader ? number_at(packet, 0, 4) : 0;
  const bool part = magic == kPart && packet.size() >= kPartHeader;
  if (magic != kWhole && !part) {
    ++strange_;
    return;
  }
  const std::uint32_t number = number_at(packet, 4, 4);
  const std::uint32_t packets = part ? number_at(packet, 18, 2) : 1;
  if (!senders_.contains(sender) && senders_.size() >= kMostSenders) senders_.erase(senders_.begin());
  const auto [found, is_new] = senders_.try_emplace(sender, Sender{.number = number, .missing = packets});
  Sender& known = found->second;
  if (!is_new && number == known.number && known.missing > 0) {  // a further packet of the same message
    --known.missing;
    return;
  }
  const std::uint32_t ahead = number - known.number;  // numbers wrap around
  if (!is_new) {
    if (ahead < kJump && ahead > 1) lost_ += ahead - 1;
    if (known.missing > 0) ++incomplete_;
  }
  known = {.number = number, .missing = packets - 1};
  ++messages_;
}

}  // namespace fathom::runtime

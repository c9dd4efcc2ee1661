// Any bytes as a message of every type: decoded or refused, and what passes is encoded and decoded to the same again.
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "common/wire/streams.hpp"

namespace {

using namespace fathom;

template <class Message>
void check(const std::uint8_t* data, int size) {
  Message message{};
  std::vector<std::uint8_t> bytes(data, data + size);
  // A fuzzer will not find the eight bytes that name a type.
  const std::int64_t name = Message::getHash();
  for (int i = 0; i < 8 && i < size; ++i) {
    bytes[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(name) >> (56 - 8 * i));
  }
  if (message.decode(bytes.data(), 0, size) < 0) return;
  const auto sample = wire::decode(message);
  if (!sample) return;
  const Message again = wire::encode(*sample);
  std::vector<std::uint8_t> out(static_cast<std::size_t>(again.getEncodedSize()));
  if (again.encode(out.data(), 0, static_cast<int>(out.size())) < 0) std::abort();
  Message back{};
  if (back.decode(out.data(), 0, static_cast<int>(out.size())) < 0 || !wire::decode(back)) std::abort();
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 9) return 0;
  Recording types;
  std::uint8_t index = 0;
  wire::visit_streams(types, [&](const char*, auto& stream) {
    using Sample = typename std::remove_reference_t<decltype(stream)>::value_type;
    if (data[0] % 26 == index++) check<wire::MessageOf<Sample>>(data + 1, static_cast<int>(size - 1));
  });
  return 0;
}

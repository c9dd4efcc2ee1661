// Signing messages, and telling whether they were: the last 32 bytes of OPERATOR, WRENCH_COMMAND and ANSWER are the
// keyed hash of all bytes before them, the type's fingerprint included (docs/messages.md).
#pragma once

#include <algorithm>
#include <iterator>
#include <span>
#include <vector>

#include "common/base/signing.hpp"
#include "common/wire/minds.hpp"

namespace fathom::wire {

/// What `message.signature` must be under `key`. Allocates only for the first message of a thread.
template <class Message>
[[nodiscard]] Signature signature_for(const Message& message, const Key& key) {
  thread_local std::vector<std::uint8_t> bytes;
  bytes.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return signature_of(key, std::span<const std::uint8_t>{bytes}.first(bytes.size() - sizeof message.signature));
}

template <class Message>
[[nodiscard]] bool authentic(const Message& message, const Key& key) {
  Signature said{};
  std::copy(std::begin(message.signature), std::end(message.signature), said.begin());
  return same(said, signature_for(message, key));
}

/// The sample with `authentic` as it was found; nothing where decode() refuses.
template <class Message>
[[nodiscard]] auto open(const Message& message, const Key& key) {
  auto sample = decode(message);
  if (sample) sample->authentic = authentic(message, key);
  return sample;
}

/// The sample's message, signed.
template <class Sample>
[[nodiscard]] auto encode_signed(const Sample& sample, const Key& key) {
  auto message = encode(sample);
  const Signature signature = signature_for(message, key);
  std::copy(signature.begin(), signature.end(), std::begin(message.signature));
  return message;
}

}  // namespace fathom::wire

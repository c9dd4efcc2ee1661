#include "common/base/signing.hpp"

#include <sodium.h>

#include "common/base/error.hpp"

namespace fathom {

static_assert(crypto_auth_hmacsha256_BYTES == std::tuple_size_v<Signature>);
static_assert(crypto_auth_hmacsha256_KEYBYTES == std::tuple_size_v<Key>);

Signature signature_of(const Key& key, std::span<const std::uint8_t> text) {
  Signature signature{};
  crypto_auth_hmacsha256(signature.data(), text.data(), text.size(), key.data());
  return signature;
}

Key derived(const Key& key, std::string_view purpose) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(purpose.data());
  return signature_of(key, {bytes, purpose.size()});
}

bool same(const Signature& a, const Signature& b) { return sodium_memcmp(a.data(), b.data(), a.size()) == 0; }

std::int64_t unforeseeable() {
  if (sodium_init() < 0) throw InputError("libsodium finds no source of random numbers on this machine");
  std::uint64_t number = 0;
  randombytes_buf(&number, sizeof number);
  return static_cast<std::int64_t>((number >> 1U) | 1U);
}

}  // namespace fathom

// Signatures against published numbers: RFC 4231 (HMAC-SHA-256).
#include "common/base/signing.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace fathom;

namespace {

std::string hex(const Signature& signature) {
  std::string text;
  for (const std::uint8_t each : signature) {
    text += "0123456789abcdef"[each >> 4U];
    text += "0123456789abcdef"[each & 15U];
  }
  return text;
}

std::span<const std::uint8_t> bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

TEST_CASE("signing: HMAC-SHA-256 as RFC 4231 gives it") {
  // A key shorter than a block is filled up with zeros, so the RFC's shorter ones may be written as 32 bytes.
  Key first{};
  for (std::size_t i = 0; i < 20; ++i) first[i] = 0x0b;
  CHECK(hex(signature_of(first, bytes("Hi There"))) ==
        "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7");
  Key jefe{'J', 'e', 'f', 'e'};
  CHECK(hex(signature_of(jefe, bytes("what do ya want for nothing?"))) ==
        "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
}

TEST_CASE("signing: one bit of key or text makes another signature, and what cannot be foreseen is above 0") {
  const Signature one = signature_of(Key{}, bytes("text"));
  Key other{};
  other[31] = 1;
  CHECK(same(one, one));
  CHECK_FALSE(same(one, signature_of(other, bytes("text"))));
  CHECK_FALSE(same(one, signature_of(Key{}, bytes("texu"))));
  const std::int64_t a = unforeseeable(), b = unforeseeable();
  CHECK(a > 0);
  CHECK(b > 0);
  CHECK(a != b);
}

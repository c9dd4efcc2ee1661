// Keyed hashes: who holds the key can tell that a message was made by another one who holds it, and nobody else can
// make one. HMAC-SHA-256 (RFC 2104, FIPS 180-4) of libsodium.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace fathom {

/// 256 bits. A key never leaves its process: no message, no log and no HEALTH holds it.
using Key = std::array<std::uint8_t, 32>;
using Signature = std::array<std::uint8_t, 32>;

/// HMAC-SHA-256 of `text` under `key`.
[[nodiscard]] Signature signature_of(const Key& key, std::span<const std::uint8_t> text);
/// A key of its own for each purpose: HMAC-SHA-256 of the purpose's name. From one of them no other can be found.
[[nodiscard]] Key derived(const Key& key, std::string_view purpose);
/// Compares in a time that tells nothing about where they differ.
[[nodiscard]] bool same(const Signature& a, const Signature& b);
/// A number above 0 that nobody can foresee, from the kernel.
[[nodiscard]] std::int64_t unforeseeable();

}  // namespace fathom

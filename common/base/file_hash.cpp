#include "common/base/file_hash.hpp"

#include <sodium.h>

#include <array>
#include <fstream>
#include <vector>

#include "common/base/error.hpp"

namespace fathom {

FileHash hash_of_file(const std::string& path) {
  constexpr std::size_t kBlock = 1U << 16U;
  std::ifstream file{path, std::ios::binary};
  if (!file) throw InputError(path + ": cannot be read");
  crypto_hash_sha256_state state;
  crypto_hash_sha256_init(&state);
  FileHash hash;
  std::vector<char> block(kBlock);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto count = static_cast<std::uint64_t>(file.gcount());
    crypto_hash_sha256_update(&state, reinterpret_cast<const unsigned char*>(block.data()), count);
    hash.bytes += count;
  }
  if (file.bad()) throw InputError(path + ": cannot be read to its end");
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
  crypto_hash_sha256_final(&state, digest.data());
  std::array<char, 2 * crypto_hash_sha256_BYTES + 1> text{};
  sodium_bin2hex(text.data(), text.size(), digest.data(), digest.size());
  hash.sha256 = text.data();
  return hash;
}

}  // namespace fathom

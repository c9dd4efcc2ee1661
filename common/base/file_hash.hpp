// SHA-256 of a file (FIPS 180-4), so that a result names the data that it rests on.
#pragma once

#include <cstdint>
#include <string>

namespace fathom {

struct FileHash {
  std::string sha256;  ///< hexadecimal, as `sha256sum` prints it
  std::uint64_t bytes{};
};

/// Streams the file. InputError when it cannot be read.
[[nodiscard]] FileHash hash_of_file(const std::string& path);

}  // namespace fathom

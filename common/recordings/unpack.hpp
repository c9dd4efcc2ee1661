// Unpacking of zstd, lz4 frames and bz2, as far as the bytes are whole: what stands before damage is kept.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/recordings/file_window.hpp"

namespace fathom::recordings {

enum class Packing : std::uint8_t { kNone, kZstd, kLz4, kBz2 };

struct Unpacked {
  std::vector<std::uint8_t> bytes;
  bool whole{};  ///< the packing ended as it should
};

/// At most `most` bytes; memory grows only as bytes come.
void unpack(Packing packing, Bytes packed, std::size_t most, Unpacked& out);

/// CRC-32 as in zip and MCAP.
[[nodiscard]] std::uint32_t crc32(Bytes bytes);

}  // namespace fathom::recordings

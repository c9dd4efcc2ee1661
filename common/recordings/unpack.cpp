#include "common/recordings/unpack.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

namespace fathom::recordings {
namespace {

constexpr std::size_t kStep = std::size_t{1} << 18U;

/// Room for the next bytes; false when there is as much as may be.
bool grow(Unpacked& out, std::size_t used, std::size_t most) {
  if (used < out.bytes.size()) return true;
  if (out.bytes.size() >= most) return false;
  out.bytes.resize(std::min(most, out.bytes.size() + std::max(kStep, out.bytes.size() / 2)));
  return true;
}

void zstd(Bytes packed, std::size_t most, Unpacked& out) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context{ZSTD_createDCtx(), ZSTD_freeDCtx};
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  std::size_t used = 0;
  std::size_t left = 1;
  while (grow(out, used, most)) {
    ZSTD_outBuffer to{out.bytes.data(), out.bytes.size(), used};
    const std::size_t before = in.pos;
    left = ZSTD_decompressStream(context.get(), &to, &in);
    const bool moved = to.pos != used || in.pos != before;
    used = to.pos;
    if (ZSTD_isError(left) != 0 || !moved || (left == 0 && in.pos == in.size)) break;
  }
  out.whole = left == 0 && in.pos == in.size;
  out.bytes.resize(used);
}

void lz4(Bytes packed, std::size_t most, Unpacked& out) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0) return;
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context{made,
                                                                                     LZ4F_freeDecompressionContext};
  std::size_t at = 0, used = 0, left = 1;
  while (grow(out, used, most)) {
    std::size_t to = out.bytes.size() - used, from = packed.size() - at;
    left = LZ4F_decompress(context.get(), out.bytes.data() + used, &to, packed.data() + at, &from, nullptr);
    if (LZ4F_isError(left) != 0) {
      left = 1;
      break;
    }
    used += to;
    at += from;
    if ((to == 0 && from == 0) || (left == 0 && at == packed.size())) break;
  }
  out.whole = left == 0 && at == packed.size();
  out.bytes.resize(used);
}

void bz2(Bytes packed, std::size_t most, Unpacked& out) {
  bz_stream stream{};
  if (packed.size() > std::numeric_limits<unsigned>::max() || BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return;
  std::vector<char> in(packed.begin(), packed.end());  // the library does not promise to leave its input alone
  stream.next_in = in.data();
  stream.avail_in = static_cast<unsigned>(in.size());
  std::size_t used = 0;
  int state = BZ_OK;
  while (state == BZ_OK && grow(out, used, most)) {
    stream.next_out = reinterpret_cast<char*>(out.bytes.data()) + used;
    stream.avail_out = static_cast<unsigned>(std::min<std::size_t>(out.bytes.size() - used, 1U << 30U));
    const unsigned room = stream.avail_out, before = stream.avail_in;
    state = BZ2_bzDecompress(&stream);
    used += room - stream.avail_out;
    if (stream.avail_out == room && stream.avail_in == before && state == BZ_OK) break;
  }
  BZ2_bzDecompressEnd(&stream);
  out.whole = state == BZ_STREAM_END;
  out.bytes.resize(used);
}

}  // namespace

void unpack(Packing packing, Bytes packed, std::size_t most, Unpacked& out) {
  out.bytes.clear();
  out.whole = false;
  switch (packing) {
    case Packing::kZstd:
      return zstd(packed, most, out);
    case Packing::kLz4:
      return lz4(packed, most, out);
    case Packing::kBz2:
      return bz2(packed, most, out);
    default:
      out.bytes.assign(packed.begin(), packed.end());
      out.whole = true;
  }
}

std::uint32_t crc32(Bytes bytes) {
  static const std::array<std::array<std::uint32_t, 256>, 4> table = [] {
    std::array<std::array<std::uint32_t, 256>, 4> made{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) value = value >> 1U ^ ((value & 1U) != 0 ? 0xEDB88320U : 0U);
      made[0][i] = value;
    }
    for (std::uint32_t i = 0; i < 256; ++i) {
      for (std::size_t k = 1; k < 4; ++k) made[k][i] = made[k - 1][i] >> 8U ^ made[0][made[k - 1][i] & 0xFFU];
    }
    return made;
  }();
  std::uint32_t crc = 0xFFFFFFFFU;
  std::size_t i = 0;
  for (; i + 4 <= bytes.size(); i += 4) {
    crc ^= bytes[i] | static_cast<std::uint32_t>(bytes[i + 1]) << 8U | static_cast<std::uint32_t>(bytes[i + 2]) << 16U |
           static_cast<std::uint32_t>(bytes[i + 3]) << 24U;
    crc = table[3][crc & 0xFFU] ^ table[2][crc >> 8U & 0xFFU] ^ table[1][crc >> 16U & 0xFFU] ^ table[0][crc >> 24U];
  }
  for (; i < bytes.size(); ++i) crc = crc >> 8U ^ table[0][(crc ^ bytes[i]) & 0xFFU];
  return ~crc;
}

}  // namespace fathom::recordings

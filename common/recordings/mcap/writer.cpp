#include "common/recordings/mcap/writer.hpp"

#include <zstd.h>

#include <algorithm>
#include <limits>
#include <span>

#include "common/base/error.hpp"
#include "common/recordings/unpack.hpp"

namespace fathom::recordings::mcap {
namespace {

constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
constexpr std::size_t kChunkSize = std::size_t{1} << 22U;  // bytes before packing: a second or so of everything
constexpr int kLevel = 3;                                  // zstd's own default
enum Opcode : std::uint8_t {
  kHeader = 1,
  kFooter,
  kSchema,
  kChannel,
  kMessage,
  kChunk,
  kMessageIndex,
  kChunkIndex,
  kStatistics = 0x0B,
  kMetadata,
  kSummaryOffset = 0x0E,
  kDataEnd
};

template <class Unsigned>
void add(std::string& body, Unsigned value) {
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) body += static_cast<char>(value >> (8U * i) & 0xFFU);
}

void add_text(std::string& body, std::string_view text) {
  add(body, static_cast<std::uint32_t>(text.size()));
  body += text;
}

template <class Key, class Value>
void add_map(std::string& body, const std::map<Key, Value>& map) {
  std::string inner;
  for (const auto& [key, value] : map) {
    if constexpr (std::is_same_v<Key, std::string>) {
      add_text(inner, key);
      add_text(inner, value);
    } else {
      add(inner, key);
      add(inner, value);
    }
  }
  add_text(body, inner);
}

std::uint32_t checksum(std::string_view bytes) {
  return crc32(std::span{reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

}  // namespace

Writer::Writer(const std::string& path) : path_{path}, file_{path, std::ios::binary} {
  if (!file_) throw InputError(path + ": cannot be written; check the folder's permissions and free space");
  put(std::string{kMagic});
  std::string body, bytes;
  add_text(body, "");
  add_text(body, "fathom");
  record(kHeader, body, bytes);
  put(bytes);
}

void Writer::record(std::uint8_t opcode, const std::string& body, std::string& into) const {
  into += static_cast<char>(opcode);
  add(into, static_cast<std::uint64_t>(body.size()));
  into += body;
}

void Writer::put(const std::string& bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  at_ += bytes.size();
}

std::uint16_t Writer::open(const std::string& topic, const std::string& schema_name, const std::string& schema) {
  const std::uint16_t id = ++opened_;
  std::string body, records;
  add(body, id);
  add_text(body, schema_name);
  add_text(body, "jsonschema");
  add_text(body, schema);
  record(kSchema, body, records);
  schemas_ += records;
  chunk_ += records;
  body.clear();
  records.clear();
  add(body, id);
  add(body, id);  // a schema for each channel
  add_text(body, topic);
  add_text(body, "json");
  add_map(body, std::map<std::string, std::string>{});
  record(kChannel, body, records);
  channels_ += records;
  chunk_ += records;
  return id;
}

void Writer::message(std::uint16_t channel, std::uint64_t logged, std::uint64_t published, std::string_view data) {
  const bool first = index_.empty();
  chunk_begin_ = first ? logged : std::min(chunk_begin_, logged);
  chunk_end_ = first ? logged : std::max(chunk_end_, logged);
  begin_ = messages_ == 0 ? logged : std::min(begin_, logged);
  end_ = messages_ == 0 ? logged : std::max(end_, logged);
  index_[channel].emplace_back(logged, chunk_.size());
  std::string body;
  add(body, channel);
  add(body, static_cast<std::uint32_t>(++counts_[channel]));
  add(body, logged);
  add(body, published);
  body += data;
  record(kMessage, body, chunk_);
  ++messages_;
  if (chunk_.size() >= kChunkSize) end_chunk();
}

void Writer::metadata(const std::string& name, const std::map<std::string, std::string>& words) {
  end_chunk();
  std::string body, bytes;
  add_text(body, name);
  add_map(body, words);
  record(kMetadata, body, bytes);
  put(bytes);
  ++metadata_;
}

void Writer::end_chunk() {
  if (index_.empty()) return;  // channels that were opened and have said nothing wait for the next
  std::string packed(ZSTD_compressBound(chunk_.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), chunk_.data(), chunk_.size(), kLevel);
  if (ZSTD_isError(size) != 0) throw InputError(path_ + ": zstd: " + ZSTD_getErrorName(size));
  packed.resize(size);
  Chunk chunk{.begin = chunk_begin_, .end = chunk_end_, .offset = at_, .packed = size, .size = chunk_.size()};
  std::string body, bytes;
  add(body, chunk.begin);
  add(body, chunk.end);
  add(body, chunk.size);
  add(body, checksum(chunk_));
  add_text(body, "zstd");
  add(body, static_cast<std::uint64_t>(packed.size()));
  body += packed;
  record(kChunk, body, bytes);
  chunk.length = bytes.size();
  put(bytes);
  const std::uint64_t indices = at_;
  for (auto& [channel, entries] : index_) {
    chunk.index[channel] = at_;
    std::ranges::stable_sort(entries);
    std::string list;
    for (const auto& [time, offset] : entries) {
      add(list, time);
      add(list, offset);
    }
    body.clear();
    bytes.clear();
    add(body, channel);
    add_text(body, list);
    record(kMessageIndex, body, bytes);
    put(bytes);
  }
  chunk.index_length = at_ - indices;
  chunks_.push_back(std::move(chunk));
  chunk_.clear();
  index_.clear();
}

void Writer::close() {
  end_chunk();
  std::string body, bytes;
  add(body, std::uint32_t{0});  // no checksum of the whole: every chunk has its own
  record(kDataEnd, body, bytes);
  put(bytes);

  const std::uint64_t summary_begin = at_;
  std::string summary, offsets;
  const auto group = [&](std::uint8_t opcode, const std::string& records) {
    if (records.empty()) return;
    std::string entry;
    entry += static_cast<char>(opcode);
    add(entry, summary_begin + summary.size());
    add(entry, static_cast<std::uint64_t>(records.size()));
    record(kSummaryOffset, entry, offsets);
    summary += records;
  };
  group(kSchema, schemas_);
  group(kChannel, channels_);
  std::string chunks;
  for (const Chunk& chunk : chunks_) {
    body.clear();
    add(body, chunk.begin);
    add(body, chunk.end);
    add(body, chunk.offset);
    add(body, chunk.length);
    add_map(body, chunk.index);
    add(body, chunk.index_length);
    add_text(body, "zstd");
    add(body, chunk.packed);
    add(body, chunk.size);
    record(kChunkIndex, body, chunks);
  }
  group(kChunkIndex, chunks);
  body.clear();
  add(body, messages_);
  add(body, opened_);
  add(body, static_cast<std::uint32_t>(opened_));
  add(body, std::uint32_t{0});
  add(body, metadata_);
  add(body, static_cast<std::uint32_t>(chunks_.size()));
  add(body, begin_);
  add(body, end_);
  add_map(body, counts_);
  std::string statistics;
  record(kStatistics, body, statistics);
  group(kStatistics, statistics);

  const std::uint64_t offsets_begin = summary_begin + summary.size();
  body.clear();
  add(body, summary_begin);
  add(body, offsets_begin);
  // The checksum covers summary, offsets and the footer up to itself.
  std::string footer;
  footer += static_cast<char>(kFooter);
  add(footer, std::uint64_t{20});
  footer += body;
  add(body, checksum(summary + offsets + footer));
  bytes.clear();
  record(kFooter, body, bytes);
  put(summary + offsets + bytes + std::string{kMagic});
  file_.flush();
  if (!file_) throw InputError(path_ + ": cannot be written to its end; check the free space");
}

}  // namespace fathom::recordings::mcap

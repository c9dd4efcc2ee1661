#include "common/link/raw_log.hpp"

#include <array>
#include <filesystem>
#include <string_view>

#include "common/base/error.hpp"

namespace fathom::link {
namespace {

constexpr std::string_view kMagic = "FATHOMRAW1\n";
constexpr std::uint32_t kMostPiece = 1U << 20;  // no read is larger
constexpr std::size_t kBarePiece = 64;          // bytes that get one time where none was recorded

template <std::size_t N>
std::uint64_t from_bytes(const std::array<char, N>& raw) {
  std::uint64_t value = 0;
  for (std::size_t i = N; i-- > 0;) value = value << 8 | static_cast<std::uint8_t>(raw[i]);
  return value;
}

template <std::size_t N>
std::array<char, N> to_bytes(std::uint64_t value) {
  std::array<char, N> raw{};
  for (char& byte : raw) {
    byte = static_cast<char>(value & 0xFFU);
    value >>= 8;
  }
  return raw;
}

}  // namespace

std::string free_name(const std::string& path) {
  std::string name = path;
  for (int i = 1; std::filesystem::exists(name); ++i) name = path + "." + std::to_string(i);
  return name;
}

RawWriter::RawWriter(const std::string& path) : path_{path} {
  if (std::filesystem::exists(path)) throw InputError(path + ": is there already; name another file for the raw bytes");
  file_.open(path, std::ios::binary);
  if (!file_) throw InputError(path + ": cannot be written; check that the folder exists and is yours");
  file_ << kMagic;
}

void RawWriter::write(Utime utime, std::span<const std::uint8_t> bytes) {
  const auto time = to_bytes<8>(static_cast<std::uint64_t>(utime));
  const auto count = to_bytes<4>(bytes.size());
  file_.write(time.data(), time.size());
  file_.write(count.data(), count.size());
  file_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file_.flush();
  if (!file_) throw InputError(path_ + ": writing failed; is the disk full?");
}

RawReader::RawReader(const std::string& path, Utime start, double rate)
    : path_{path}, file_{path, std::ios::binary}, start_{start}, rate_{rate} {
  if (!file_ || std::filesystem::is_directory(path)) throw InputError(path + ": cannot be read; check the name");
  std::string magic(kMagic.size(), '\0');
  file_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  stamped_ = magic == kMagic;
  if (stamped_) return;
  file_.clear();
  file_.seekg(0);
}

std::optional<RawPiece> RawReader::next() {
  RawPiece piece;
  if (!stamped_) {
    piece.bytes.resize(kBarePiece);
    file_.read(reinterpret_cast<char*>(piece.bytes.data()), kBarePiece);
    piece.bytes.resize(static_cast<std::size_t>(file_.gcount()));
    if (piece.bytes.empty()) return {};
    count_ += piece.bytes.size();
    piece.utime = utime_after(start_, static_cast<double>(count_) / rate_);
    return piece;
  }
  std::array<char, 8> time{};
  std::array<char, 4> count{};
  if (!file_.read(time.data(), time.size())) return {};
  file_.read(count.data(), count.size());
  const auto size = static_cast<std::uint32_t>(from_bytes(count));
  if (!file_ || size > kMostPiece) throw InputError(path_ + ": damaged after its first pieces; it cannot be read on");
  piece.utime = static_cast<Utime>(from_bytes(time));
  piece.bytes.resize(size);
  file_.read(reinterpret_cast<char*>(piece.bytes.data()), size);
  piece.bytes.resize(static_cast<std::size_t>(file_.gcount()));  // a recording may end in the middle of a piece
  return piece;
}

}  // namespace fathom::link

#include "common/recordings/packed/packed.hpp"

#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkstemp is POSIX's
#include <unistd.h>
#include <zstd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "common/base/error.hpp"
#include "common/recordings/formats.hpp"
#include "common/recordings/little.hpp"

namespace fathom::recordings::packed {
namespace {

constexpr std::uint32_t kMagic = 0xFD2FB528;
constexpr std::size_t kPiece = std::size_t{1} << 20U;

/// A file that is gone when this is.
class Temporary {
 public:
  Temporary() : path_((std::filesystem::temp_directory_path() / "fathom-unpacked-XXXXXX").string()) {
    file_ = ::mkstemp(path_.data());
    if (file_ < 0) throw InputError(path_ + ": cannot be made: " + std::strerror(errno));
  }
  ~Temporary() {
    ::close(file_);
    ::unlink(path_.c_str());
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  void write(const std::uint8_t* bytes, std::size_t count) {
    while (count > 0) {
      const ssize_t put = ::write(file_, bytes, count);
      if (put < 0 && errno == EINTR) continue;
      if (put <= 0) throw InputError(path_ + ": writing failed: " + std::strerror(errno));
      bytes += put;
      count -= static_cast<std::size_t>(put);
    }
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  int file_{-1};
};

}  // namespace

bool is_zstd(Bytes head) { return head.size() >= 4 && little<std::uint32_t>(head) == kMagic; }

void read(const std::string& path, Sink& sink, Damage& damage) {
  FileWindow file{path};
  Temporary plain;
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context{ZSTD_createDCtx(), ZSTD_freeDCtx};
  std::vector<std::uint8_t> out(kPiece);
  std::size_t left = 1;
  for (std::uint64_t at = 0; at < file.size();) {
    const Bytes bytes = file.at(at, kPiece);
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    while (in.pos < in.size) {
      ZSTD_outBuffer to{out.data(), out.size(), 0};
      left = ZSTD_decompressStream(context.get(), &to, &in);
      plain.write(out.data(), to.pos);
      if (ZSTD_isError(left) != 0) {
        damage.add("stretches that cannot be unpacked", at + in.pos, file.size() - at - in.pos);
        at = file.size();
        break;
      }
    }
    at += bytes.size();
  }
  for (;;) {  // what the context still holds
    ZSTD_inBuffer none{nullptr, 0, 0};
    ZSTD_outBuffer to{out.data(), out.size(), 0};
    if (left == 0 || ZSTD_isError(left) != 0 || ZSTD_isError(ZSTD_decompressStream(context.get(), &to, &none)) != 0 ||
        to.pos == 0)
      break;
    plain.write(out.data(), to.pos);
  }
  const Format* format = format_of(plain.path());
  if (format == nullptr || format->read == &read)
    throw InputError(path + ": packed by zstd, and what is in it is not known");
  try {
    format->read(plain.path(), sink, damage);
  } catch (const InputError& error) {  // in the words of the file that was given
    std::string text = error.what();
    if (text.starts_with(plain.path())) text = path + " (unpacked)" + text.substr(plain.path().size());
    throw InputError(text);
  }
}

}  // namespace fathom::recordings::packed

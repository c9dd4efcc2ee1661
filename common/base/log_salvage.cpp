#include "common/base/log_salvage.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/base/error.hpp"
#include "common/base/event_format.hpp"

namespace fathom {
namespace {

using event_format::Header;
using event_format::kHeaderSize;
using event_format::kSync;
using Bytes = std::span<const std::uint8_t>;

constexpr std::uint64_t kNowhere = ~std::uint64_t{0};

class Search {
 public:
  explicit Search(Bytes log) : log_{log} {}

  /// Where the event that begins at `at` would end; nowhere when none does, or when it is cut off.
  [[nodiscard]] std::uint64_t end_of(std::uint64_t at) const {
    if (!sync_at(at) || log_.size() - at < kHeaderSize) return kNowhere;
    const Header header = header_at(at);
    if (!header.plausible() || log_.size() - at - kHeaderSize < header.body()) return kNowhere;
    const auto* name = reinterpret_cast<const char*>(log_.data() + at + kHeaderSize);
    const bool readable = std::all_of(name, name + header.channel_length, [](char c) { return c > 32 && c < 127; });
    return readable ? at + kHeaderSize + header.body() : kNowhere;
  }
  /// An event that is followed by another one or by the end of the file: no doubt about it.
  [[nodiscard]] bool certain(std::uint64_t at) const {
    const std::uint64_t end = end_of(at);
    return end != kNowhere && (end == log_.size() || sync_at(end));
  }
  /// The first such event in [from, to).
  [[nodiscard]] std::uint64_t next_certain(std::uint64_t from, std::uint64_t to) const {
    for (std::uint64_t at = next_sync(from); at < to; at = next_sync(at + 1)) {
      if (certain(at)) return at;
    }
    return kNowhere;
  }
  /// The event's length may be a lie that swallows whole ones behind it.
  [[nodiscard]] bool whole(std::uint64_t at) const {
    const std::uint64_t end = end_of(at);
    return certain(at) || (end != kNowhere && next_certain(at + 1, end) == kNowhere);
  }
  [[nodiscard]] std::uint64_t next_sync(std::uint64_t from) const {
    const auto found =
        std::search(log_.begin() + static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(from, log_.size())), log_.end(),
                    kSync.begin(), kSync.end());
    return found == log_.end() ? kNowhere : static_cast<std::uint64_t>(found - log_.begin());
  }
  [[nodiscard]] std::string channel_at(std::uint64_t at) const {
    return {reinterpret_cast<const char*>(log_.data() + at + kHeaderSize), header_at(at).channel_length};
  }

  [[nodiscard]] bool begins_anew(std::uint64_t before, std::uint64_t at) const {
    return event_format::begins_anew(header_at(before), header_at(at));
  }

 private:
  [[nodiscard]] bool sync_at(std::uint64_t at) const {
    return at + kSync.size() <= log_.size() && std::equal(kSync.begin(), kSync.end(), log_.data() + at);
  }
  [[nodiscard]] Header header_at(std::uint64_t at) const {
    return Header{std::span<const std::uint8_t, kHeaderSize>{log_.data() + at, kHeaderSize}};
  }
  Bytes log_;
};

/// A whole file to look at, without reading it into memory.
class Mapped {
 public:
  explicit Mapped(const std::string& path) {
    const auto fail = [&](const std::string& why) { throw InputError(path + ": cannot be read (" + why + ")"); };
    if (std::filesystem::is_directory(path)) fail("it is a folder; name the log file itself");
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) fail(std::strerror(errno));
    struct stat status {};
    fstat(file, &status);
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ > 0) start_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
    close(file);
    if (start_ == MAP_FAILED) fail(std::strerror(errno));
  }
  ~Mapped() {
    if (start_ != nullptr) munmap(start_, size_);
  }
  Mapped(const Mapped&) = delete;
  Mapped& operator=(const Mapped&) = delete;
  [[nodiscard]] Bytes bytes() const { return {static_cast<const std::uint8_t*>(start_), size_}; }

 private:
  void* start_{nullptr};
  std::size_t size_{};
};

}  // namespace

std::uint64_t Salvage::lost() const {
  std::uint64_t sum = 0;
  for (const Damage& each : damages) sum += each.bytes;
  return sum;
}

Salvage salvage(Bytes log, const std::function<void(Bytes, std::size_t)>& keep) {
  const Search search{log};
  Salvage result;
  std::uint64_t before = kNowhere;
  for (std::uint64_t at = 0; at < log.size();) {
    if (search.whole(at)) {
      const std::uint64_t end = search.end_of(at);
      if (before == kNowhere || search.begins_anew(before, at))
        result.parts.push_back({.begin = at, .events_before = result.events});
      before = at;
      keep(log.subspan(at, end - at), result.parts.size() - 1);
      ++result.channels[search.channel_at(at)];
      ++result.events;
      result.bytes += end - at;
      at = end;
      continue;
    }
    std::uint64_t next = search.next_sync(at + 1);
    while (next != kNowhere && !search.whole(next)) next = search.next_sync(next + 1);
    next = std::min<std::uint64_t>(next, log.size());
    result.damages.push_back({.offset = at, .bytes = next - at, .events_before = result.events});
    at = next;
  }
  return result;
}

namespace {

/// The recordings' files; a lone one has the name that was asked for.
class Parts {
 public:
  explicit Parts(std::string to) : to_{std::move(to)} {}
  /// Nothing half done stays behind.
  ~Parts() {
    std::error_code ignored;
    for (const std::string& path : finished_ ? std::vector<std::string>{} : paths_)
      std::filesystem::remove(path, ignored);
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;
  void write(Bytes event, std::size_t part) {
    if (part == paths_.size()) begin();
    file_.write(reinterpret_cast<const char*>(event.data()), static_cast<std::streamsize>(event.size()));
  }
  /// False when something could not be written.
  [[nodiscard]] bool finish() {
    file_.close();
    finished_ = sound_ && file_.good();
    return finished_;
  }
  [[nodiscard]] const std::vector<std::string>& paths() const { return paths_; }

 private:
  void begin() {
    if (paths_.size() == 1) {  // a second one: the first gets its number too
      const std::string first = numbered(1);
      refuse_existing(first);
      std::filesystem::rename(to_, first);
      paths_.front() = first;
    }
    if (file_.is_open()) {
      file_.close();
      sound_ = sound_ && file_.good();
    }
    const std::string path = paths_.empty() ? to_ : numbered(paths_.size() + 1);
    refuse_existing(path);
    file_.open(path, std::ios::binary);
    if (!file_) throw InputError(path + ": cannot be written; check that the folder exists and is yours");
    paths_.push_back(path);
  }
  static void refuse_existing(const std::string& path) {
    if (std::filesystem::exists(path)) throw InputError(path + ": exists already; name another file");
  }
  [[nodiscard]] std::string numbered(std::size_t number) const {
    const std::filesystem::path whole{to_};
    return (whole.parent_path() / (whole.stem().string() + "-" + std::to_string(number))).string() +
           whole.extension().string();
  }

  std::string to_;
  std::ofstream file_;
  std::vector<std::string> paths_;
  bool sound_{true}, finished_{};
};

}  // namespace

Salvage salvage(const std::string& from, const std::string& to) {
  const Mapped log{from};
  if (std::filesystem::exists(to)) throw InputError(to + ": exists already; name another file");
  Parts parts{to};
  Salvage result = salvage(log.bytes(), [&](Bytes event, std::size_t part) { parts.write(event, part); });
  if (result.events == 0) throw InputError(from + ": holds no whole event of an LCM log");
  if (!parts.finish()) throw InputError(to + ": writing failed; is the disk full?");
  for (std::size_t i = 0; i < result.parts.size(); ++i) result.parts[i].path = parts.paths()[i];
  return result;
}

}  // namespace fathom

// A file as a window of bytes that slides forward: any length of recording in the same few megabytes of memory.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fathom::recordings {

using Bytes = std::span<const std::uint8_t>;

class FileWindow {
 public:
  /// InputError when the file cannot be opened.
  explicit FileWindow(const std::string& path);
  ~FileWindow();
  FileWindow(const FileWindow&) = delete;
  FileWindow& operator=(const FileWindow&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// `count` bytes from `offset` on, fewer at the end of the file; they live until the next call. Never more is taken
  /// into memory than the file holds.
  [[nodiscard]] Bytes at(std::uint64_t offset, std::size_t count) {
    if (offset >= begin_ && offset - begin_ <= held_ && held_ - (offset - begin_) >= count)
      return {buffer_.data() + (offset - begin_), count};
    if (offset >= begin_ && offset <= begin_ + held_ && begin_ + held_ == size_ && held_ > 0)  // the last of the file
      return {buffer_.data() + (offset - begin_), static_cast<std::size_t>(begin_ + held_ - offset)};
    return refill(offset, count);
  }
  /// What the window holds from `offset` on, at least one byte unless the file ends there.
  [[nodiscard]] Bytes rest(std::uint64_t offset) {
    if (offset < begin_ || offset >= begin_ + held_) (void)refill(offset, 1);
    if (offset >= begin_ + held_) return {};
    return {buffer_.data() + (offset - begin_), static_cast<std::size_t>(held_ - (offset - begin_))};
  }

 private:
  Bytes refill(std::uint64_t offset, std::size_t count);

  std::string path_;
  int file_{-1};
  std::uint64_t size_{};
  std::uint64_t begin_{};  ///< of the window in the file
  std::uint64_t held_{};   ///< bytes in it
  std::vector<std::uint8_t> buffer_;
};

}  // namespace fathom::recordings

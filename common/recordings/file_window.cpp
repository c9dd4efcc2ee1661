#include "common/recordings/file_window.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/base/error.hpp"

namespace fathom::recordings {
namespace {

constexpr std::size_t kWindow = std::size_t{1} << 20U;  // bytes read at once

}  // namespace

FileWindow::FileWindow(const std::string& path) : path_(path) {
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  struct stat about {};
  if (::fstat(file_, &about) != 0 || !S_ISREG(about.st_mode)) {
    ::close(file_);
    throw InputError(path + ": is no file that can be read");
  }
  size_ = static_cast<std::uint64_t>(about.st_size);
}

FileWindow::~FileWindow() { ::close(file_); }

Bytes FileWindow::refill(std::uint64_t offset, std::size_t count) {
  const std::uint64_t left = offset < size_ ? size_ - offset : 0;
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(std::max(count, kWindow), left));
  if (buffer_.size() < wanted) buffer_.resize(wanted);
  begin_ = offset;
  held_ = 0;
  while (held_ < wanted) {
    const ssize_t got = ::pread(file_, buffer_.data() + held_, wanted - held_, static_cast<off_t>(offset + held_));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(path_ + ": cannot be read: " + std::strerror(errno));
    if (got == 0) break;  // it became shorter meanwhile
    held_ += static_cast<std::uint64_t>(got);
  }
  return {buffer_.data(), static_cast<std::size_t>(std::min<std::uint64_t>(count, held_))};
}

}  // namespace fathom::recordings

#include "common/base/paged.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "common/base/error.hpp"

namespace fathom {
namespace {

std::string folder() {
  const char* stated = std::getenv("TMPDIR");
  return stated != nullptr && *stated != '\0' ? stated : "/var/tmp";
}

[[noreturn]] void refuse(int why) {
  throw InputError(folder() + ": a long table is kept there while it is read, and that cannot be done: " +
                   std::strerror(why) + "; name a folder with room (eight bytes a cell) in TMPDIR");
}

}  // namespace

PageFile::PageFile() {
  const std::string where = folder();
  descriptor_ = ::open(where.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor_ < 0) {  // a file system without such files
    std::string path = where + "/fathom-XXXXXX";
    descriptor_ = ::mkostemp(path.data(), O_CLOEXEC);
    if (descriptor_ >= 0) (void)::unlink(path.c_str());
  }
  if (descriptor_ < 0) refuse(errno);
}

PageFile::~PageFile() { ::close(descriptor_); }

void PageFile::write(std::uint64_t at, const void* from, std::size_t size) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t count =
        ::pwrite(descriptor_, static_cast<const char*>(from) + done, size - done, static_cast<off_t>(at + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) refuse(count < 0 ? errno : ENOSPC);
    done += static_cast<std::size_t>(count);
  }
}

void PageFile::read(std::uint64_t at, void* to, std::size_t size) const {
  for (std::size_t done = 0; done < size;) {
    const ssize_t count =
        ::pread(descriptor_, static_cast<char*>(to) + done, size - done, static_cast<off_t>(at + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) refuse(count < 0 ? errno : EIO);
    done += static_cast<std::size_t>(count);
  }
}

}  // namespace fathom

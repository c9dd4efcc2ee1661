#include "common/recordings/matlab/matlab.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/recordings/arrays/arrays.hpp"
#include "common/recordings/little.hpp"
#include "common/recordings/matlab/variables.hpp"

namespace fathom::recordings::matlab {
namespace {

constexpr std::size_t kHeader = 128;
constexpr std::size_t kMostBytes = std::size_t{1} << 32U;  // of all arrays

/// Reads all that a pipe gives.
std::vector<std::uint8_t> all_of(int pipe) {
  std::vector<std::uint8_t> bytes;
  for (;;) {
    const std::size_t at = bytes.size();
    bytes.resize(at + 65536);
    const ssize_t got = ::read(pipe, bytes.data() + at, 65536);
    bytes.resize(at + static_cast<std::size_t>(got > 0 ? got : 0));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0 || bytes.size() > kMostBytes) return bytes;
  }
}

/// Version 4 has no mark: a type, sizes and a name that make sense.
bool is_version_4(Bytes head) {
  if (head.size() < 24) return false;
  const auto type = little<std::uint32_t>(head), rows = little<std::uint32_t>(head, 4),
             columns = little<std::uint32_t>(head, 8);
  const auto imaginary = little<std::uint32_t>(head, 12), name = little<std::uint32_t>(head, 16);
  if (type > 52 || type % 10 > 2 || type / 10 > 5 || imaginary > 1 || name < 2 || name > 64 || head.size() < 20 + name)
    return false;
  if (rows == 0 || columns == 0 || rows > (1U << 28U) || columns > (1U << 28U) || head[20 + name - 1] != 0)
    return false;
  for (std::size_t i = 20; i + 1 < 20 + name; ++i) {
    if (head[i] < '0' || head[i] > 'z') return false;
  }
  return true;
}

/// Variables of versions 5 and 7 stand one behind the other, each with its length: the library does not say when the
/// last is cut off.
void look_for_end(FileWindow& file, Damage& damage) {
  const Bytes mark = file.at(124, 4);
  const bool is_little = mark.size() == 4 && mark[0] == 0 && mark[1] == 1 && mark[2] == 'I';
  const bool is_big = mark.size() == 4 && mark[0] == 1 && mark[1] == 0 && mark[2] == 'M';
  if (!is_little && !is_big) return;
  std::uint64_t at = kHeader;
  while (at < file.size()) {
    const Bytes tag = file.at(at, 8);
    const std::uint64_t length = tag.size() < 8 ? file.size()
                                 : is_big       ? big<std::uint32_t>(tag, 4)
                                                : little<std::uint32_t>(tag, 4);
    if (length > file.size() - at - std::min<std::uint64_t>(8, file.size() - at))
      return damage.add("variables cut off by the end of the file", at, file.size() - at);
    at += 8 + length;
  }
}

}  // namespace

bool is_mat(Bytes head) {
  const std::string_view text{reinterpret_cast<const char*>(head.data()), head.size()};
  if (head.size() >= kHeader && text.starts_with("MATLAB ")) return true;
  const bool marked =
      head.size() >= kHeader && (text.substr(126, 2) == "IM" || text.substr(126, 2) == "MI") &&
      (text.substr(124, 2) == std::string_view("\0\1", 2) || text.substr(124, 2) == std::string_view("\1\0", 2));
  return marked || is_version_4(head);
}

void read(const std::string& path, Sink& sink, Damage& damage) {
  FileWindow file{path};
  look_for_end(file, damage);
  int ends[2];
  if (::pipe(ends) != 0) throw InputError(path + ": no pipe to read it through: " + std::strerror(errno));
  const pid_t child = ::fork();
  if (child < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw InputError(path + ": no process to read it in: " + std::strerror(errno));
  }
  if (child == 0) {
    ::close(ends[0]);
    send_variables(path, ends[1]);
    ::_exit(0);
  }
  ::close(ends[1]);
  const std::vector<std::uint8_t> bytes = all_of(ends[0]);
  ::close(ends[0]);
  int state = 0;
  while (::waitpid(child, &state, 0) < 0 && errno == EINTR) {
  }
  std::vector<arrays::Array> all;
  const bool ended = received(bytes, all, damage);
  if (!ended) {
    if (all.empty()) throw InputError(path + ": is damaged: nothing in it can be read");
    damage.add("rest of the file, behind damage");
  }
  arrays::say(all, sink, damage);
}

}  // namespace fathom::recordings::matlab

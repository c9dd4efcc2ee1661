#include "common/runtime/record_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <system_error>
#include <utility>

#include "common/base/error.hpp"

namespace fathom::runtime {
namespace {

constexpr std::uint64_t kEventHead = 28;  // B: sync word, number, time, length of channel and of data

constexpr std::uint64_t kNotYetThere = 1'000'000;  // B: more than any buffer of stdio holds back

InputError failed(const std::string& path, int number) {
  return InputError{path + ": writing failed (" + std::strerror(number) + "); is the disk full?"};
}

}  // namespace

RecordFile::RecordFile(std::string path) : path_{std::move(path)}, log_{std::make_unique<lcm::LogFile>(path_, "w")} {
  if (!log_->good()) throw InputError(path_ + ": cannot be written; check that the folder exists and is yours");
}

RecordFile::~RecordFile() { end(); }

void RecordFile::write(const std::string& channel, std::span<std::uint8_t> bytes, Utime utime) {
  lcm::LogEvent event{};
  event.timestamp = utime;
  event.channel = channel;
  event.datalen = static_cast<std::int32_t>(bytes.size());
  event.data = bytes.data();
  errno = 0;
  while (since_.size() > 1 && since_.front() + kNotYetThere < size_) since_.pop_front();
  since_.push_back(size_);
  if (log_->writeEvent(&event) != 0) throw failed(path_, errno);
  size_ += kEventHead + channel.size() + bytes.size();
}

void RecordFile::keep() {
  if (std::fflush(log_->getFilePtr()) != 0) throw failed(path_, errno);
  fdatasync(fileno(log_->getFilePtr()));  // not every file system can, and a pipe cannot
}

void RecordFile::end() noexcept {
  if (!log_) return;
  log_.reset();
  std::error_code none;
  if (!std::filesystem::is_regular_file(path_, none)) return;
  const std::uint64_t there = std::filesystem::file_size(path_, none);
  if (none) return;
  std::uint64_t whole = std::min(there, size_);
  if (there < size_ || there > size_) {  // the disk took a part: up to the last event that begins and ends in it
    since_.push_back(size_);
    const auto above = std::upper_bound(since_.begin(), since_.end(), there);
    if (above != since_.begin()) whole = *std::prev(above);
    std::filesystem::resize_file(path_, whole, none);
  }
  if (whole == 0) std::filesystem::remove(path_, none);
}

std::string next_numbered(const std::string& path) {
  const std::filesystem::path whole{path};
  const std::filesystem::path folder = whole.has_parent_path() ? whole.parent_path() : ".";
  const std::string begin = whole.filename().string() + ".";
  unsigned long next = 0;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator{folder, none}) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin)) continue;
    const std::string number = name.substr(begin.size());
    constexpr std::size_t kMostDigits = 9;
    const bool digits =
        !number.empty() && number.size() <= kMostDigits && number.find_first_not_of("0123456789") == std::string::npos;
    if (digits) next = std::max(next, std::stoul(number) + 1);
  }
  char end[32];
  std::snprintf(end, sizeof end, ".%02lu", next);
  return path + end;
}

}  // namespace fathom::runtime

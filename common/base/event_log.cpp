#include "common/base/event_log.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/event_format.hpp"

namespace fathom {
namespace {

using event_format::Header;
using event_format::kHeaderSize;
using event_format::kSync;

bool begins_with_sync(std::span<const std::uint8_t> bytes) {
  const std::size_t length = std::min(bytes.size(), kSync.size());
  return std::equal(kSync.begin(), kSync.begin() + static_cast<std::ptrdiff_t>(length), bytes.begin());
}

}  // namespace

EventLog::EventLog(std::string path) : path_{std::move(path)} {
  std::error_code error;
  if (std::filesystem::is_directory(path_, error)) {
    throw InputError(path_ + ": is a folder; name the log file itself");
  }
  file_.open(path_, std::ios::binary);
  if (!file_)
    throw InputError(path_ + ": cannot be read (" + std::strerror(errno) + "); check the name and its rights");
  size_ = std::filesystem::file_size(path_, error);
  if (error) throw InputError(path_ + ": cannot be read (" + error.message() + "); a log must be a plain file");
  std::array<std::uint8_t, 4> start{};
  if (size_ == 0) throw InputError(path_ + ": empty file, no LCM log; record one with lcm-logger");
  if (size_ < start.size() || !read(start) || !begins_with_sync(start)) {
    throw InputError(path_ +
                     ": byte 0: not an LCM log (those begin with ED A1 DA 01); record one with lcm-logger, or make one "
                     "of another recording or table with 'fathom import'");
  }
  file_.seekg(0);
}

std::optional<LogEvent> EventLog::next() {
  const std::uint64_t left = size_ - offset_;
  if (left == 0 || !warning_.empty()) return {};
  std::array<std::uint8_t, kHeaderSize> bytes{};
  const std::size_t available = std::min<std::uint64_t>(left, kHeaderSize);
  if (!read(std::span{bytes}.first(available))) throw InputError(place() + "reading failed; is the disk sound?");
  if (!begins_with_sync(std::span{bytes}.first(available))) {
    throw InputError(place() + "rubbish where an event should begin; " + remedy());
  }
  const Header header{bytes};
  if (available == kHeaderSize && !header.plausible()) {
    throw InputError(place() + "absurd length (channel " + std::to_string(header.channel_length) + ", data " +
                     std::to_string(header.data_length) + " bytes); " + remedy());
  }
  if (available < kHeaderSize || left - kHeaderSize < header.body()) {
    if (another_event_follows()) throw InputError(place() + "length reaches past the end of the file; " + remedy());
    warning_ = place() + "the last event is cut off; " + std::to_string(events_) + " events recovered";
    return {};
  }
  body_.resize(header.body());
  if (!read(body_)) throw InputError(place() + "reading failed; is the disk sound?");
  const std::span<const std::uint8_t> body{body_};
  LogEvent event{.time = header.time,
                 .offset = offset_,
                 .begins_anew = before_ && event_format::begins_anew(*before_, header),
                 .channel = {reinterpret_cast<const char*>(body.data()), header.channel_length},
                 .data = body.subspan(header.channel_length)};
  before_ = header;
  offset_ += kHeaderSize + header.body();
  ++events_;
  return event;
}

bool EventLog::read(std::span<std::uint8_t> into) {
  file_.read(reinterpret_cast<char*>(into.data()), static_cast<std::streamsize>(into.size()));
  return static_cast<bool>(file_);
}

std::string EventLog::place() const {
  return path_ + ": byte " + std::to_string(offset_) + " (after " + std::to_string(events_) + " events): ";
}

std::string EventLog::remedy() const {
  return "keep what is before and behind it with: fathom repair-log LOG --out REPAIRED";
}

// A cut-off event is the last thing in its file. Whole events behind it mean that its length is a lie.
bool EventLog::another_event_follows() {
  std::vector<std::uint8_t> rest(size_ - offset_);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(offset_));
  if (!read(rest)) return false;
  for (auto at = rest.begin() + 1; at != rest.end(); ++at) {
    at = std::search(at, rest.end(), kSync.begin(), kSync.end());
    if (static_cast<std::size_t>(rest.end() - at) < kHeaderSize) return false;
    const Header header{std::span<const std::uint8_t, kHeaderSize>{&*at, kHeaderSize}};
    const auto behind = static_cast<std::uint64_t>(rest.end() - at) - kHeaderSize;
    if (header.plausible() && header.body() <= behind) return true;
  }
  return false;
}

}  // namespace fathom

#include "common/wire/log_writer.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <numeric>
#include <system_error>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/wire/streams.hpp"

namespace fathom::wire {
namespace {

/// A stream on its way to the log, in the order of time. Nothing is held but its place, unless it is out of order.
class Outgoing {
 public:
  template <class Sample>
  Outgoing(const char* channel, const std::vector<Sample>& samples)
      : channel_{channel}, samples_{&samples}, size_{samples.size()}, time_{&time_of<Sample>}, code_{&code<Sample>} {
    if (!std::ranges::is_sorted(samples, {}, &Sample::utime)) {
      order_.resize(size_);
      std::iota(order_.begin(), order_.end(), std::size_t{0});
      std::ranges::stable_sort(order_, {}, [&](std::size_t i) { return samples[i].utime; });
    }
    look();
  }
  [[nodiscard]] const char* channel() const { return channel_; }
  [[nodiscard]] bool done() const { return at_ == size_; }
  [[nodiscard]] Utime next() const { return next_; }  ///< time of the sample that is next
  void take(std::vector<std::uint8_t>& bytes) {
    code_(samples_, place(), bytes);
    ++at_;
    look();
  }

 private:
  template <class Sample>
  static const Sample& of(const void* samples, std::size_t i) {
    return (*static_cast<const std::vector<Sample>*>(samples))[i];
  }
  template <class Sample>
  static Utime time_of(const void* samples, std::size_t i) {
    return of<Sample>(samples, i).utime;
  }
  template <class Sample>
  static void code(const void* samples, std::size_t i, std::vector<std::uint8_t>& bytes) {
    const MessageOf<Sample> message = encode(of<Sample>(samples, i));
    const int length = message.getEncodedSize();
    bytes.resize(static_cast<std::size_t>(length));
    message.encode(bytes.data(), 0, length);
  }
  [[nodiscard]] std::size_t place() const { return order_.empty() ? at_ : order_[at_]; }
  void look() {
    if (!done()) next_ = time_(samples_, place());
  }

  const char* channel_;
  const void* samples_;
  std::size_t size_, at_{};
  std::vector<std::size_t> order_;
  Utime (*time_)(const void*, std::size_t);
  void (*code_)(const void*, std::size_t, std::vector<std::uint8_t>&);
  Utime next_{};
};

std::vector<Outgoing> streams_of(const Recording& recording) {
  std::vector<Outgoing> streams;
  visit_streams(recording, [&](const char* channel, const auto& samples) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (decode(encode(samples[i]))) continue;
      throw InputError(recording.name + ": channel " + channel + ": sample " + std::to_string(i) + " at utime " +
                       std::to_string(samples[i].utime) +
                       " holds a non-finite number or a quaternion that is not unit; leave it out");
    }
    if (!samples.empty()) streams.emplace_back(channel, samples);
  });
  return streams;
}

/// The stream whose sample is next, the first of those at the same time; null when all are done.
Outgoing* earliest(std::vector<Outgoing>& streams) {
  Outgoing* found = nullptr;
  for (Outgoing& one : streams) {
    if (!one.done() && (found == nullptr || one.next() < found->next())) found = &one;
  }
  return found;
}

}  // namespace

class LogWriter::File {
 public:
  File(const std::string& path, const std::string& name) : log_{path, "w"} {
    if (!log_.good()) throw InputError(name + ": cannot be written; check that the folder exists and is yours");
  }
  void write(Outgoing& stream) {
    event_.timestamp = stream.next();
    event_.channel = stream.channel();
    stream.take(bytes_);
    event_.datalen = static_cast<std::int32_t>(bytes_.size());
    event_.data = bytes_.data();
    written_ = written_ && log_.writeEvent(&event_) == 0;
  }
  [[nodiscard]] bool flush() { return written_ && std::fflush(log_.getFilePtr()) == 0; }

 private:
  lcm::LogFile log_;
  lcm::LogEvent event_{};
  std::vector<std::uint8_t> bytes_;
  bool written_{true};
};

LogWriter::LogWriter(std::string path) : path_{std::move(path)}, written_{path_} {
  std::error_code unknown;
  if (!std::filesystem::exists(path_, unknown) || std::filesystem::is_regular_file(path_, unknown)) written_ += ".part";
}

LogWriter::~LogWriter() {
  if (!file_) return;
  file_.reset();
  std::error_code ignored;
  if (written_ != path_) std::filesystem::remove(written_, ignored);
}

void LogWriter::append(const Recording& part) {
  std::vector<Outgoing> streams = streams_of(part);
  if (!file_) file_ = std::make_unique<File>(written_, path_);
  while (Outgoing* const stream = earliest(streams)) file_->write(*stream);
  std::size_t place = 0;
  visit_streams(part, [&](const char* channel, const auto& samples) {
    if (place == counts_.size()) counts_.emplace_back(channel, 0);
    counts_[place++].second += samples.size();
    events_ += samples.size();
  });
  if (!file_->flush()) throw InputError(path_ + ": writing failed; is the disk full?");
}

std::uint64_t LogWriter::finish() {
  if (!file_) append({});
  file_.reset();
  std::error_code failed;
  if (written_ != path_) std::filesystem::rename(written_, path_, failed);
  if (failed) throw InputError(path_ + ": cannot be written: " + failed.message());
  return events_;
}

std::string LogWriter::counts() const {
  std::string text;
  for (const auto& [channel, count] : counts_) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::string{channel} + " " + std::to_string(count);
  }
  return text;
}

std::uint64_t write_log(const Recording& recording, const std::string& path) {
  LogWriter log{path};
  log.append(recording);
  return log.finish();
}

}  // namespace fathom::wire

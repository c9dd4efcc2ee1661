// An LCM event log of any length, some of it after the other.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "common/samples/recording.hpp"
#include "common/wire/log_reader.hpp"
#include "common/wire/streams.hpp"

namespace fathom::wire {

/// Memory that a sample takes, with what it holds beside itself where that comes often: bytes.
template <class Sample>
[[nodiscard]] std::size_t bytes_of(const Sample&) {
  return sizeof(Sample);
}
[[nodiscard]] inline std::size_t bytes_of(const Thrusters& sample) {
  return sizeof(Thrusters) + sizeof(double) * (sample.pwm_us.size() + sample.force.size());
}
[[nodiscard]] inline std::size_t bytes_of(const Recording& recording) {
  std::size_t bytes = 0;
  visit_streams(recording, [&](const char*, const auto& stream) {
    for (const auto& sample : stream) bytes += bytes_of(sample);
  });
  return bytes;
}

/// A log some events after the others: of a long one nothing is held but the part that is asked for.
class LogParts {
 public:
  /// InputError when the file cannot be read or is no event log.
  explicit LogParts(const std::string& path);
  ~LogParts();
  LogParts(const LogParts&) = delete;
  LogParts& operator=(const LogParts&) = delete;

  /// The samples of the next events, each stream in the order of its stamps, until they take some `most` bytes; into
  /// empty streams. False when no event is left. InputError when the file is damaged, holds no channel that Fathom
  /// knows, or several recordings that were joined: sorted into one another they would be two vehicles at once.
  bool next(std::size_t most, Recording& part);
  /// Of the events until now.
  [[nodiscard]] LogReport report() const;
  /// Of the file that has been read, 0 to 1.
  [[nodiscard]] double share() const;

 private:
  struct Reader;
  std::unique_ptr<Reader> reader_;
};

}  // namespace fathom::wire

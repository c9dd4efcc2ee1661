// What a recording of any format is made of: topics with named numbers, and messages with their times. A reader says
// what a file holds, in the order of the file; a sink takes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::recordings {

/// A number of a topic: "GyrX", "pose.position.x", "channels[3]". In the units of the file; nothing is turned.
struct Field {
  std::string name;
  std::string unit{};  ///< as the file or the format's documents say; empty: not known
};

/// Messages of one kind from one source. An instance (a second IMU) is a topic of its own.
struct Topic {
  std::string name;  ///< "/imu/data", "BARO[1]"; unique within a file
  std::string type;  ///< "sensor_msgs/msg/Imu"
  std::vector<Field> fields;
};

inline constexpr std::int64_t kNoTime = std::numeric_limits<std::int64_t>::min();

/// Times of a message [us]. `log` is the recording's own clock, the same for all topics: receipt where the format has
/// it. `measured` is the clock of whoever measured (header.stamp, time_boot_ms, timestamp_sample), or kNoTime.
struct Stamp {
  std::int64_t log{kNoTime};
  std::int64_t measured{kNoTime};
};

class Sink {
 public:
  virtual ~Sink() = default;
  /// A topic appears; topics are counted from zero. True when its numbers are wanted: else messages come without.
  virtual bool topic(std::size_t number, const Topic& topic) = 0;
  /// A list became longer than any before it: the topic has further fields at its end.
  virtual void further_field(std::size_t topic, const Field& field) = 0;
  /// `values` are in the order of the fields, as many as are known so far or none; absent ones are NaN.
  virtual void message(std::size_t topic, Stamp stamp, std::span<const double> values) = 0;
  /// The first text of a topic that has words beside or instead of numbers.
  virtual void text(std::size_t topic, std::string_view field, std::string_view words) = 0;
};

}  // namespace fathom::recordings

// Takes what a reader says: an account of every topic, and the rows of those columns that somebody asked for.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/paged.hpp"
#include "common/recordings/stamp_guard.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings {

/// What a number did over a recording.
struct FieldAccount {
  std::uint64_t finite{};
  double least{}, greatest{};
  double first{};
  std::uint64_t changes{};  ///< values that differ from the one before
  double latest{};
};

struct TopicAccount {
  Topic topic;
  std::uint64_t messages{};     ///< with believed stamps
  std::uint64_t refused{};      ///< whose stamp fits nothing around it
  std::uint64_t untimed{};      ///< without a time: descriptions, what was published before there was a clock
  std::int64_t first{kNoTime};  ///< us, least and greatest of log times
  std::int64_t last{kNoTime};
  std::int64_t longest_gap{};        ///< us between neighbours
  std::vector<std::int64_t> steps;   ///< us between neighbours, the first few thousand: for the median
  std::vector<std::int64_t> delays;  ///< us from measured to log, the first few thousand
  std::vector<FieldAccount> fields;  ///< as many as the topic's fields; without numbers unless they were asked for
  std::string words;                 ///< its first text, "field: words"
  std::int64_t latest{kNoTime};

  [[nodiscard]] double rate() const;  ///< Hz, from the median step; 0 for fewer than two messages
};

/// Names by which a map may call a topic: its own; "IMU" for "IMU[1]", and "IMU[0]" for "IMU", since the same logger
/// numbers what it has several of, and not what it has one of.
[[nodiscard]] std::vector<std::string> names_of_topic(const std::string& topic);
/// The number of "IMU[1]"; 0 for "IMU".
[[nodiscard]] int instance_of(const std::string& topic);

/// Rows of one topic, in the order of the file; those of a long recording lie on disk.
struct TopicRows {
  std::vector<std::string> names;  ///< "topic.field", those that were asked for, as they were asked for
  std::vector<Paged<double>> columns;
  Paged<Stamp> stamps;
  Paged<std::uint32_t> recording;
};

class Collector final : public Sink {
 public:
  enum class Take : std::uint8_t { kColumns, kEverything };
  /// `columns`: those whose rows are kept. `accounts`: kEverything looks at every number of the file.
  Collector(ClockRules clock, std::set<std::string> columns, Take accounts);
  Collector(const Collector&) = delete;
  Collector& operator=(const Collector&) = delete;

  bool topic(std::size_t number, const Topic& topic) override;
  void further_field(std::size_t topic, const Field& field) override;
  void message(std::size_t topic, Stamp stamp, std::span<const double> values) override;
  void text(std::size_t topic, std::string_view field, std::string_view words) override;
  void finish() { guard_.finish(); }

  [[nodiscard]] const std::vector<TopicAccount>& topics() const { return topics_; }
  [[nodiscard]] const std::vector<TopicRows>& rows() const { return rows_; }
  /// The rows of a topic, which are forgotten here.
  [[nodiscard]] TopicRows take(std::size_t topic) { return std::exchange(rows_[topic], {}); }
  [[nodiscard]] std::uint32_t recordings() const { return recordings_; }  ///< clocks that started anew, and one
  [[nodiscard]] std::uint64_t messages() const;
  [[nodiscard]] std::uint64_t refused() const;

 private:
  void keep(const Judged& judged, std::size_t recording);
  void ask(std::size_t topic, std::size_t field);

  struct Slot {
    std::size_t field{};
    std::size_t column{};
  };
  std::set<std::string> wanted_;
  Take take_;
  StampGuard guard_;
  std::vector<TopicAccount> topics_;
  std::vector<TopicRows> rows_;
  std::vector<std::vector<Slot>> slots_;
  std::uint32_t recordings_{1};
};

}  // namespace fathom::recordings

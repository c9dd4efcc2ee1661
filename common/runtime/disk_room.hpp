// How long a disk lasts at the rate at which it is written.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace fathom::runtime {

/// Pure: figures and times are passed in, in seconds of any steady clock.
class DiskRoom {
 public:
  struct Limits {
    double least_time{120.0};              ///< s: a trial is ended and its last words recorded in a fraction of it
    std::uint64_t least_free{32'000'000};  ///< B: other programs of the host need some, too
    double time_constant{10.0};            ///< s of the low pass of the rate: one picture is no flood
  };
  DiskRoom() : DiskRoom(Limits{}) {}
  explicit DiskRoom(const Limits& limits) : limits_{limits} {}

  /// `written` [B] since the start, `available` [B] for this user.
  void measure(std::uint64_t written, std::uint64_t available, double now);
  [[nodiscard]] double rate() const { return rate_; }  ///< B/s
  /// s until it is full; nothing while nothing is written.
  [[nodiscard]] std::optional<double> time_left() const;
  /// "12.3 GB free, full in 25 h at 0.14 MB/s".
  [[nodiscard]] std::string text() const;
  /// One line with the remedy; empty while there is room.
  [[nodiscard]] std::string trouble() const;

 private:
  Limits limits_;
  double rate_{};
  std::uint64_t written_{}, available_{};
  std::optional<double> first_, last_;
};

}  // namespace fathom::runtime

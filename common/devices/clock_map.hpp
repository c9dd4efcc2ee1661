// An instrument's clock to the host's: bytes never arrive early, so the line under all delays is the one without
// jitter.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/base/time.hpp"

namespace fathom::devices {

/// Keeps the smallest delay of every second for a minute and maps along the line that touches these from below: offset
/// and drift of the clocks, free of what operating system and line add at random. Nothing else can be known from one
/// direction; the smallest delay itself is part of the stated latency.
class ClockMap {
 public:
  /// `latency` [s]: from the moment that the values were true to the arrival of the frame at its quickest. `tick` [s]:
  /// in what steps the instrument tells time. Rounded or cut off, the quickest frames are those that the steps show
  /// latest; all others come out up to a step early, which half a step makes good in the mean. `turn` [s]: after so
  /// long it counts from zero again, as a time of day; 0: never.
  explicit ClockMap(double latency, double tick = 0.0, double turn = 0.0)
      : latency_{latency}, tick_{tick}, turn_{turn} {}

  /// Host time at which the values were true, always later than the one before. Without device time: the arrival less
  /// the latency.
  [[nodiscard]] Utime map(std::optional<double> device_time, Utime arrival);
  /// The line broke off: forgets the clock, not the count.
  void reset();
  [[nodiscard]] std::uint64_t restarts() const { return restarts_; }  ///< jumps of the instrument's clock
  /// ppm by which the instrument's clock is slow; nothing before half a minute has been seen.
  [[nodiscard]] std::optional<double> drift() const;

 private:
  struct Point {
    double device{};  ///< s
    double offset{};  ///< s, host minus device, smallest of its second
  };
  static constexpr std::size_t kWindow = 64;
  [[nodiscard]] double unrolled(double device_time);
  void insert(const Point& point);
  void fit();
  [[nodiscard]] const Point& at(std::size_t i) const { return points_[(first_ + i) % kWindow]; }

  double latency_, tick_, turn_;
  std::array<Point, kWindow> points_{};
  std::size_t first_{}, count_{};
  Utime origin_{};  ///< host time from which seconds are counted, so that doubles keep microseconds
  bool started_{false};
  double last_device_{};
  double turned_{};                     ///< s, whole turns since the clock was first heard
  double slope_{}, level_{}, pivot_{};  ///< offset = level + slope (device - pivot)
  std::optional<Utime> last_;
  std::uint64_t restarts_{};
};

}  // namespace fathom::devices

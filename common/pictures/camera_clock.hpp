// When pictures of a camera with a steady rate were taken, from when they arrived: a transport only ever delays, so the
// line under the arrivals is the camera's clock (Zhang, Liu and Xia 2002: lower convex hull; Olson 2010 for sensors).
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/base/time.hpp"

namespace fathom::pictures {

class CameraClock {
 public:
  /// `rate` [Hz] at which the camera takes its pictures; some of them may be left out.
  explicit CameraClock(double rate) : nominal_{1.0 / rate} {}

  /// Arrival of a picture, in order; returns when it would have arrived had it been delayed as little as any of late;
  /// as it came, while pictures keep no such rate. Nothing: this is when the picture before is told to have been taken,
  /// which was late by a whole period.
  std::optional<Utime> step(Utime arrival);
  /// False while pictures do not come at multiples of the period.
  [[nodiscard]] bool steady() const { return steady_; }
  /// s, by how much the last picture came later than the least delayed ones.
  [[nodiscard]] double delay() const { return delay_; }

 private:
  struct Arrival {
    std::int64_t number{};
    double t{};  ///< s since origin_
  };
  [[nodiscard]] Utime stamp(Utime arrival);
  void restart(Utime arrival);
  [[nodiscard]] bool make_room(std::int64_t number);
  [[nodiscard]] bool keeps_rate() const;
  void find_line();

  double nominal_;   ///< s
  double period_{};  ///< s, as measured
  double offset_{};  ///< s since origin_, of picture 0
  Utime origin_{};
  std::optional<Utime> told_;
  std::deque<Arrival> arrivals_;
  std::vector<Arrival> hull_;
  bool steady_{true};
  double delay_{};
};

}  // namespace fathom::pictures

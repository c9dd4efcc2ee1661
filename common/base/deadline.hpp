// When long work that may be cut short has to come to an end.
#pragma once

#include <chrono>
#include <limits>

namespace fathom {

class Deadline {
 public:
  Deadline() = default;  ///< never
  /// `seconds` from now on by the clock on the wall.
  explicit Deadline(double seconds) : seconds_{seconds} {}
  [[nodiscard]] double elapsed() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  [[nodiscard]] bool over() const { return elapsed() > seconds_; }
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_{Clock::now()};
  double seconds_{std::numeric_limits<double>::infinity()};
};

}  // namespace fathom

// The last two minutes of the motion, thinned out for strip charts.
#pragma once

#include <array>
#include <deque>

#include "common/samples/estimates.hpp"

namespace fathom::board {

/// Position [m], attitude [rad] and velocity [m/s, rad/s] as one row.
using MotionRow = std::array<double, 12>;
/// x y z, roll pitch yaw, u v w, p q r.
[[nodiscard]] MotionRow motion_row(const StateEstimate& state);

class History {
 public:
  static constexpr double kLength = 120.0;  ///< s
  static constexpr double kSpacing = 0.5;   ///< s between two points
  struct Point {
    double at{};
    MotionRow row{};
  };
  /// Keeps it when it is time for another point. `now` never falls.
  void add(const StateEstimate& state, double now);
  void forget(double now);
  [[nodiscard]] const std::deque<Point>& points() const { return points_; }

 private:
  std::deque<Point> points_;
};

}  // namespace fathom::board

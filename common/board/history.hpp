// The last two minutes of something, thinned out for strip charts.
#pragma once

#include <array>
#include <deque>

#include "common/samples/estimates.hpp"

namespace fathom::board {

/// Position [m], attitude [rad] and velocity [m/s, rad/s] as one row.
using MotionRow = std::array<double, 12>;
/// x y z, roll pitch yaw, u v w, p q r.
[[nodiscard]] MotionRow motion_row(const StateEstimate& state);

/// X Y Z [N], K M N [N m].
using WrenchRow = std::array<double, 6>;

template <class Row>
class History {
 public:
  static constexpr double kLength = 120.0;  ///< s
  static constexpr double kSpacing = 0.5;   ///< s between two points
  struct Point {
    double at{};
    Row row{};
  };
  /// Keeps it when it is time for another point. Where `now` falls all begins anew.
  void add(const Row& row, double now) {
    if (!points_.empty() && now < points_.back().at) points_.clear();
    while (!points_.empty() && now - points_.front().at > kLength) points_.pop_front();
    if (!points_.empty() && now - points_.back().at < kSpacing) return;
    points_.push_back({now, row});
  }
  [[nodiscard]] const std::deque<Point>& points() const { return points_; }

 private:
  std::deque<Point> points_;
};

}  // namespace fathom::board

// How strongly a solid boundary is felt at a distance, by two laws for bottom and walls. The flow between a hull and a
// plane falls off as the inverse square to cube of the gap (Lamb 1932, sec. 137 and 138: image of a sphere); washes and
// recirculation, and many measured curves, as an exponential, which knows no place of the plane itself.
#pragma once

#include <algorithm>
#include <cmath>

namespace fathom::model {

constexpr double kSmallestGap = 0.1;     // m: closer, hull and boundary touch
constexpr double kSmallestReach = 0.02;  // m
constexpr double kLongestReach =
    2.0;  // m for a craft of 30 kg, three times its length: what reaches farther is no boundary
constexpr double kTypicalReach = 1.0;  // m: no search begins with a longer one
constexpr double kMostBeyond = 3.0;    // reaches beyond the place that a strength is told for

/// 1 at a gap of 1 m, falling as its inverse square.
inline double proximity(double gap) {
  const double reached = std::max(gap, kSmallestGap);
  return 1.0 / (reached * reached);
}

/// 1 at the place itself, falling exponentially before it: `beyond` is how far past the place, negative before it, m.
inline double proximity_at(double beyond, double reach) {
  return std::exp(std::min(beyond / std::max(reach, kSmallestReach), kMostBeyond));
}

}  // namespace fathom::model

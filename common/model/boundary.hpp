// How strongly a solid boundary is felt at a distance. One power law for bottom and walls: the flow between a hull and
// a plane falls off as the inverse square to cube of the gap (Lamb 1932, sec. 137 and 138: image of a sphere).
#pragma once

#include <algorithm>

namespace fathom::model {

constexpr double kSmallestGap = 0.1;  // m: closer, hull and boundary touch

/// 1 at a gap of 1 m, falling as its inverse square.
inline double proximity(double gap) {
  const double reached = std::max(gap, kSmallestGap);
  return 1.0 / (reached * reached);
}

}  // namespace fathom::model

// How solid boundaries are felt: what bottom and walls have in common. Two laws of the distance: the flow between a
// hull and a plane falls off as the inverse square to cube of the gap (Lamb 1932, sec. 137 and 138: image of a sphere);
// washes and recirculation, and many measured curves, as an exponential, which knows no place of the plane itself.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "common/model/motion.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::boundary {

/// Variants of an effect: what is felt, and by which law it fades.
enum Form : int { kForce, kDrag, kExponentialForce, kExponentialDrag };
constexpr std::array kStrengthUnits{"N m^2", "m^2", "N", ""};  // by form; of drag: times the hull's own
[[nodiscard]] inline bool presses(int form) { return form == kForce || form == kExponentialForce; }
[[nodiscard]] inline bool exponential(int form) { return form >= kExponentialForce; }
/// Their names; "-" where the vehicle cannot show them: `pushed` and `moves`, a force or a drag would be felt.
[[nodiscard]] inline std::vector<std::string> names(bool pushed, bool moves) {
  return {pushed ? "force" : "-", moves ? "drag" : "-", pushed ? "exponential force" : "-",
          moves ? "exponential drag" : "-"};
}

constexpr double kSmallestGap = 0.1;     // m: closer, hull and boundary touch
constexpr double kSmallestReach = 0.02;  // m
constexpr double kLongestReach = 2.0;    // m, three lengths of a craft of 30 kg: what reaches farther is no boundary
constexpr double kTypicalReach = 1.0;    // m: no search begins with a longer one
constexpr double kMostBeyond = 3.0;      // reaches beyond the place that a strength is told for

/// 1 at a gap of 1 m, falling as its inverse square.
[[nodiscard]] inline double proximity(double gap) {
  const double reached = std::max(gap, kSmallestGap);
  return 1.0 / (reached * reached);
}

/// 1 at the place itself, falling exponentially before it: `beyond` is how far past the place, negative before it, m.
[[nodiscard]] inline double proximity_at(double beyond, double reach) {
  return std::exp(std::min(beyond / std::max(reach, kSmallestReach), kMostBeyond));
}

constexpr double kStartShare = 0.3;  // of the hull's own drag, where a search begins

/// Adds the push away from the boundary that lies `toward_B` (unit vector), or more of the hull's own drag; `near` is
/// strength times proximity.
inline void press(int form, double near, const Eigen::Vector3d& toward_B, Load& load) {
  if (presses(form)) {
    load.wrench.head<3>() -= near * toward_B;
  } else {
    load.wrench.head<3>() += near * load.drag.head<3>();
    load.drag_share += near;
  }
}

}  // namespace fathom::model::boundary

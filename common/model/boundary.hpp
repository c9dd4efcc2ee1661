// How solid boundaries are felt: what bottom and walls have in common. Two laws of the distance: the flow between a
// hull and a plane falls off as the inverse square to cube of the gap (Lamb 1932, sec. 137 and 138: image of a sphere);
// washes and recirculation, and many measured curves, as an exponential, which knows no place of the plane itself. What
// moves along a plane is drawn to it with the square of its speed, as the inverse fourth power of the gap (there).
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
enum Form : int { kForce, kDrag, kExponentialForce, kExponentialDrag, kSuction };
inline constexpr std::array kStrengthUnits{"N m^2", "m^2", "N", "",
                                           "N m^4/(m/s)^2"};  // by form; of drag: times the hull's own
[[nodiscard]] inline bool multiplies(int form) { return form == kDrag || form == kExponentialDrag; }
[[nodiscard]] inline bool exponential(int form) { return form == kExponentialForce || form == kExponentialDrag; }
/// Forms whose strength has one sign: what takes drag away, or drives off what passes by, is no boundary.
[[nodiscard]] inline bool one_sided(int form) { return multiplies(form) || form == kSuction; }
/// Their names; "-" where the vehicle cannot show them: `pushed` and `moves`, a force or a drag would be felt; `along`,
/// it moves along the boundary.
[[nodiscard]] inline std::vector<std::string> names(bool pushed, bool moves, bool along) {
  return {pushed ? "force" : "-", moves ? "drag" : "-", pushed ? "exponential force" : "-",
          moves ? "exponential drag" : "-", pushed && along ? "suction" : "-"};
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

/// How near a boundary is, by the law of that form with its place `gap` metres ahead.
[[nodiscard]] inline double nearness(int form, double gap) {
  return form == kSuction ? proximity(gap) * proximity(gap) : proximity(gap);
}

/// Strength that is worth `force` [N], or a typical share of the drag, at a gap, at a speed along the boundary [m/s].
[[nodiscard]] inline double strength_at(int form, double force, double gap, double speed) {
  if (form == kSuction) return force / (nearness(form, gap) * std::max(speed * speed, 1e-4));
  return (multiplies(form) ? kStartShare : force) / nearness(form, gap);
}

/// Adds the push away from the boundary that lies `toward_B` (unit vector), more of the hull's own drag, or what draws
/// a hull that passes by at `v_r` [m/s in B, of the water]; `near` is strength times proximity.
inline void press(int form, double near, const Eigen::Vector3d& toward_B, const Eigen::Vector3d& v_r, Load& load) {
  if (form == kSuction) {
    load.wrench.head<3>() += near * (v_r - toward_B * toward_B.dot(v_r)).squaredNorm() * toward_B;
  } else if (!multiplies(form)) {
    load.wrench.head<3>() -= near * toward_B;
  } else {
    load.wrench.head<3>() += near * load.drag.head<3>();
    load.drag_share += near;
  }
}

}  // namespace fathom::model::boundary

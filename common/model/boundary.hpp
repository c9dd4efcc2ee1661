// How solid boundaries are felt: what bottom and walls have in common. Two laws of the distance: the flow between a
// hull and a plane falls off as the inverse square to cube of the gap (Lamb 1932, sec. 137 and 138: image of a sphere);
// washes and recirculation, and many measured curves, as an exponential, which knows no place of the plane itself. What
// moves along a plane is drawn to it with the square of its speed, as the inverse fourth power of the gap (there).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/form.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::boundary {

enum class Felt { kPush, kDrag, kSuction };
enum class Fades { kWithGap, kExponentially };

/// What is felt of a boundary, and by which law it fades.
struct Law {
  const char* name;
  const char* unit;  ///< of the strength; of drag: times the hull's own
  Felt felt;
  Fades fades;
  [[nodiscard]] constexpr bool multiplies() const { return felt == Felt::kDrag; }
  [[nodiscard]] constexpr bool exponential() const { return fades == Fades::kExponentially; }
  /// Strength of one sign: what takes drag away, or drives off what passes by, is no boundary.
  [[nodiscard]] constexpr bool one_sided() const { return felt != Felt::kPush; }
  /// Whether the vehicle can show it: `pushed` and `moves`, a force or a drag would be felt; `along`, it moves along
  /// the boundary.
  [[nodiscard]] constexpr bool shows(bool pushed, bool moves, bool along) const {
    if (multiplies()) return moves;
    return pushed && (along || felt != Felt::kSuction);
  }
};
inline constexpr std::array kLaws{
    Law{.name = "force", .unit = "N m^2", .felt = Felt::kPush, .fades = Fades::kWithGap},
    Law{.name = "drag", .unit = "m^2", .felt = Felt::kDrag, .fades = Fades::kWithGap},
    Law{.name = "exponential force", .unit = "N", .felt = Felt::kPush, .fades = Fades::kExponentially},
    Law{.name = "exponential drag", .unit = "", .felt = Felt::kDrag, .fades = Fades::kExponentially},
    Law{.name = "suction", .unit = "N m^4/(m/s)^2", .felt = Felt::kSuction, .fades = Fades::kWithGap}};

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

/// How near a boundary is, by the law with its place `gap` metres ahead.
[[nodiscard]] inline double nearness(const Law& law, double gap) {
  return law.felt == Felt::kSuction ? proximity(gap) * proximity(gap) : proximity(gap);
}

/// Strength that is worth `force` [N], or a typical share of the drag, at a gap, at a speed along the boundary [m/s].
[[nodiscard]] inline double strength_at(const Law& law, double force, double gap, double speed) {
  if (law.felt == Felt::kSuction) return force / (nearness(law, gap) * std::max(speed * speed, 1e-4));
  return (law.multiplies() ? kStartShare : force) / nearness(law, gap);
}

/// Adds the push away from the boundary that lies `toward_B` (unit vector), more of the hull's own drag, or what draws
/// a hull that passes by at `v_r` [m/s in B, of the water]; `near` is strength times proximity.
inline void press(const Law& law, double near, const Eigen::Vector3d& toward_B, const Eigen::Vector3d& v_r,
                  Load& load) {
  switch (law.felt) {
    case Felt::kPush:
      load.wrench.head<3>() -= near * toward_B;
      break;
    case Felt::kDrag:
      load.wrench.head<3>() += near * load.drag.head<3>();
      load.drag_share += near;
      break;
    case Felt::kSuction:
      load.wrench.head<3>() += near * (v_r - toward_B * toward_B.dot(v_r)).squaredNorm() * toward_B;
      break;
  }
}

/// What an effect's form is by its law: the strength first; by which other number it is placed; at which it is told.
[[nodiscard]] inline FormTraits traits_of(const Law& law, NumberSet sought, NumberSet given, int obeys = -1) {
  return {.sought = sought, .given = given, .unit = law.unit, .obeys = obeys, .multiplies_drag = law.multiplies()};
}

/// One form per law: F{law}.
template <class F>
[[nodiscard]] Forms form_per_law() {
  Forms all;
  for (const Law& law : kLaws) all.push_back(std::make_unique<F>(law));
  return all;
}

}  // namespace fathom::model::boundary

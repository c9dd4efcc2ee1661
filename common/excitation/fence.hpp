// The room that excitation may use: walls, floor, surface, turns of the tether, and tilt. What would lead out is bent
// back in time to stop before contact; outside of the hard envelope nothing may be thrust at all. A vehicle that floats
// when its trial begins has not left the room: it comes in from above.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <string>

#include "common/base/spatial.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::excitation {

struct FenceSettings {
  Eigen::Vector3d low{Eigen::Vector3d::Zero()};  ///< m in W, where the vehicle's origin may be; infinite: open
  Eigen::Vector3d high{Eigen::Vector3d::Zero()};
  double hard{0.1};     ///< m beyond low and high: the envelope, outside of which all stops
  double band{0.25};    ///< m over which excitation is bent
  double braking{0.8};  ///< m/s^2 that the thrusters can surely give against the motion
  double turning{1.0};  ///< rad/s^2, likewise
  double waterline{std::numeric_limits<double>::infinity()};  ///< m, z of the water's surface in W; infinite: none
  double half_length{0.0};    ///< m, of the hull's longer side: what a tilted one reaches up and down
  double turns{1.5};          ///< of the tether to either side
  double largest_speed{1.5};  ///< m/s
  double largest_rate{3.0};   ///< rad/s
  double largest_tilt{0.9};   ///< rad
};

class Fence {
 public:
  struct Bent {
    Vector6d tau{Vector6d::Zero()};
    /// Axes X Y Z N whose push leads outwards: the signal shall turn.
    std::array<bool, 6> turn{};
    bool bent{false};
  };

  explicit Fence(const FenceSettings& settings) : settings_{settings} {}

  /// `tau` [N, N m, body] so altered that the vehicle stays inside; `mass` [kg] and `inertia` [kg m^2] roughly;
  /// `turned` [rad]: heading unwound since the start.
  [[nodiscard]] Bent bend(const Vector6d& tau, const StateEstimate& state, double turned, double mass, double inertia,
                          const Vector6d& largest) const;
  /// Above the upper bound, and no farther out of the water than waves and the depth's error make believe.
  [[nodiscard]] bool floats(const Eigen::Vector3d& p_WB) const;
  /// A trial begins here. Who floats is outside only when lifted farther up, until follow() has seen it below the upper
  /// bound. For a craft that does not dive the bound is moved out of its way.
  void begin(const Eigen::Vector3d& p_WB, bool dives);
  void follow(const Eigen::Vector3d& p_WB);
  /// It began afloat and has not come down yet.
  [[nodiscard]] bool afloat() const { return afloat_; }
  /// Why all must stop now; empty inside the envelope.
  [[nodiscard]] std::string outside(const StateEstimate& state, double turned) const;
  /// Where it is, in an operator's words: place, water above the hull, room to the nearest bound. `surface` [m]: z of
  /// Bo with the hull's top at the water's surface.
  [[nodiscard]] std::string place(const StateEstimate& state, double surface) const;
  /// True when the vehicle can be there with this velocity and still stop inside.
  [[nodiscard]] bool holds(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& v_WB) const;
  [[nodiscard]] Eigen::Vector3d middle() const;
  [[nodiscard]] const FenceSettings& settings() const { return settings_; }

 private:
  /// m to the bound in the south, north, west, east, up and down; negative beyond it.
  [[nodiscard]] double room(const Eigen::Vector3d& p_WB, std::size_t side) const;

  FenceSettings settings_;
  bool afloat_{false};
  double lifted_{};  // m, z above which a vehicle that began afloat has been lifted
};

}  // namespace fathom::excitation

// A vehicle of hydrodynamic derivatives flown through a standard manoeuvre in virtual time: rigid body, umbilical and
// chain, steered by two thrusters or by its rudders. For trials that are to be reconstructed, and to compare sets of
// derivatives with each other and with what is published of their vehicle.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/model/vehicle.hpp"

namespace fathom::model {

enum class ManoeuvreKind { kLine, kZigzag, kCircle };

/// "line", "zigzag" or "circle"; InputError otherwise.
[[nodiscard]] ManoeuvreKind manoeuvre_from(const std::string& name);

/// Rest, straight ahead, and then what the kind says. A circle goes to port. Who steers by rudders begins at the
/// cruising speed of its set, with propellers that keep it: no rest, thrust and difference say nothing there.
struct Manoeuvre {
  ManoeuvreKind kind{ManoeuvreKind::kCircle};
  double rest{6.0};                       ///< s
  double straight{6.0};                   ///< s
  double duration{95.0};                  ///< s in all
  double thrust{11.5};                    ///< N of each of the two thrusters ahead
  double difference{3.2};                 ///< N by which one gives more and the other less while turning
  double swing{0.35};                     ///< rad of heading at which a zigzag turns back
  double rudder{0.35};                    ///< rad to which rudders are put over
  double rudder_rate{0.0};                ///< rad/s at which they go there; 0: at once
  Eigen::Vector3d start{3.0, 10.0, 0.0};  ///< m; the depth is where the vehicle hangs at rest
  double heading{0.0};                    ///< rad
};

/// The preset of that name: how long and with how much thrust it is flown.
[[nodiscard]] Manoeuvre manoeuvre_preset(const std::string& name);

/// Whether a rudder, and not two thrusters, turns it.
[[nodiscard]] bool steered_by_rudder(const Vehicle& vehicle);
/// The manoeuvre of that name for this vehicle: the preset, or for who is steered by rudders as long as ships need.
[[nodiscard]] Manoeuvre manoeuvre_for(const Vehicle& vehicle, const std::string& name);

/// Who flies it, open loop: only a zigzag looks at the heading.
class ManoeuvrePilot {
 public:
  explicit ManoeuvrePilot(const Manoeuvre& manoeuvre) : manoeuvre_{manoeuvre} {}
  /// What both thrusters give, and by how much port gives more and starboard less (to turn to starboard); in the unit
  /// of the manoeuvre's thrust. At `t` [s] from the start, at this yaw [rad]; zero when it is over. Times never fall.
  struct Demand {
    double ahead{}, turn{};
  };
  [[nodiscard]] Demand demand(double t, double yaw);
  /// Port and starboard [N].
  [[nodiscard]] std::vector<double> thrust(double t, double yaw);
  [[nodiscard]] const Manoeuvre& manoeuvre() const { return manoeuvre_; }

 private:
  Manoeuvre manoeuvre_;
  double side_{1.0};  // to which a zigzag turns
};

/// How a vehicle without thrust comes to rest, on its chain if it has one; heading north.
struct HangingRest {
  double depth{};  ///< m
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};
};
/// InputError when the vehicle file has no hydrodynamics.
[[nodiscard]] HangingRest hanging_rest(const Vehicle& vehicle);

/// Everything about one instant of a flight.
struct FlightMoment {
  double t{};  ///< s
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};
  Vector6d nu{Vector6d::Zero()}, nu_dot{Vector6d::Zero()};
  std::vector<double> thrust;            ///< N each; of a rudder at its reference speed
  Vector6d umbilical{Vector6d::Zero()};  ///< N, N m at Bo, in B, disturbance included
  Vector6d chain{Vector6d::Zero()};
  Eigen::Vector3d F_umbilical_B{Eigen::Vector3d::Zero()}, F_chain_B{Eigen::Vector3d::Zero()};  ///< N at the attachment
};

/// Additional force [N in W] at the umbilical's attachment at time t.
using Disturbance = std::function<Eigen::Vector3d(double t)>;

/// A motion that runs away: no vehicle of this size is so fast.
struct Divergence {
  double t{};         ///< s
  int axis{};         ///< 0..5 = u v w p q r, the fastest
  double velocity{};  ///< m/s or rad/s along it
  std::string term;   ///< the derivative that has put most into it; empty: none has
  double force{};     ///< N or N m of that term then
  /// "diverges at 23.4 s along v (6.1 m/s), driven by Y_vv (420 N)".
  [[nodiscard]] std::string text() const;
};

/// What trials of ships are compared by (IMO MSC.137(76)); nothing where the motion did not come so far.
struct TurnFigures {
  std::optional<double> advance;            ///< m ahead until the heading has changed by 90 deg
  std::optional<double> transfer;           ///< m to the side then
  std::optional<double> tactical_diameter;  ///< m to the side when it has changed by 180 deg
  double radius{};                          ///< m, at the end
};
/// Of a manoeuvre's circle: from where it begins to turn, against the course that it was to hold before.
[[nodiscard]] TurnFigures turn_figures(const std::vector<FlightMoment>& flight, const Manoeuvre& manoeuvre);

/// Moments `dt` apart. InputError when the vehicle file has no hydrodynamics, no rudder and not two thrusters. A motion
/// that diverges is flown until then where `diverged` takes the reason, else InputError with it.
[[nodiscard]] std::vector<FlightMoment> fly(const Vehicle& vehicle, const Manoeuvre& manoeuvre, double dt,
                                            const Disturbance& disturbance = nullptr,
                                            std::optional<Divergence>* diverged = nullptr);

/// What is known of the motion without derivatives: the wrench that hydrodynamics must have given, b of A x = b
/// (Pereira and Duncan, eq. 1): M nu_dot + C_RB nu - weight and buoyancy - known.
[[nodiscard]] Vector6d hydrodynamic_wrench(const Vehicle& vehicle, const Eigen::Quaterniond& q_WB, const Vector6d& nu,
                                           const Vector6d& nu_dot, const Vector6d& known);

}  // namespace fathom::model

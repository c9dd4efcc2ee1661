// A vehicle as its file describes it: what moves, what drives it, and what is known beforehand.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/model/candidates/candidate.hpp"
#include "common/model/hydrodynamics.hpp"
#include "common/model/mounts.hpp"

namespace fathom::model {

/// Force of a thruster over its command, piecewise linear, at `voltage`.
struct ThrustCurve {
  std::vector<double> pwm_us;  ///< us, rising
  std::vector<double> force;   ///< N, never falling
  double neutral_us{};         ///< us, command that means "stop": the mirror of `pwm_sign`
  double voltage{};            ///< V at which the curve was measured; 0 when unknown
  double voltage_exponent{};   ///< force ~ (V / voltage)^exponent; 0: the voltage plays no part
  [[nodiscard]] bool empty() const { return pwm_us.empty(); }
  /// Force [N] at `pwm` [us]; held at the ends.
  [[nodiscard]] double force_at(double pwm) const;
  /// Force [N] of a thruster whose command is mirrored about neutral when `pwm_sign` is -1, at `battery` [V].
  [[nodiscard]] double force_at(double pwm, double pwm_sign, double battery) const;
};

/// What a command to an actuator means. kForce and kPulse are read as they always were: a pulse where there is a curve.
enum class CommandKind { kForce, kShaftSpeed, kFinAngle, kAzimuthForce, kAzimuthAngle, kWeight };

/// A rudder or fin: `force` of an actuator is what its deflection gives at the reference speed.
struct Fin {
  double slope{};            ///< N/rad at the reference speed
  double stall{};            ///< rad: beyond it the force grows no more
  double reference_speed{};  ///< m/s
  int behind{-1};            ///< place of the propeller in whose slipstream it stands; -1: none
  double slipstream{};       ///< (m/s)^2 that each N of that propeller's thrust adds to the square of the speed
};

/// Weight that an actuator gains or loses, or moves through the hull: it pulls along the world's down, whatever the
/// attitude. `force` of an actuator is the weight gained [N], or the moment of the weight moved when level [N m].
struct Weight {
  enum class Kind {
    kGained,  ///< at the actuator's place: buoyancy engine, ballast tank
    kSlid,    ///< along `way_B`
    kTurned   ///< about a line along the hull: first along `way_B`, and up
  };
  Kind kind{Kind::kGained};
  /// Force over command: gained N/m^3 (of volume displaced; negative) or N/kg (of water taken in), slid N (over m);
  /// turned N m, the weight's moment at 90 deg.
  double per_command{};
  Eigen::Vector3d way_B{Eigen::Vector3d::Zero()};  ///< unit
};

struct Thruster {
  std::string name;
  Eigen::Vector3d p_BJ{Eigen::Vector3d::Zero()};     ///< m, position in the body
  Eigen::Vector3d axis_B{Eigen::Vector3d::UnitX()};  ///< unit, direction of positive force
  double pwm_sign{1.0};                              ///< -1: the command is mirrored about neutral before the curve
  CommandKind command{CommandKind::kForce};
  double per_square{};  ///< N/(rad/s)^2 of shaft speed ahead, in still water
  double astern{1.0};   ///< times that astern
  double diameter{};    ///< m, of a propeller by shaft speed; 0: none
  double inflow{};      ///< N^(1/2)/(m/s): ahead f = f_0 - inflow sqrt|f_0| u_a, u_a the water's speed past it
  std::optional<Fin> fin;
  std::optional<Weight> weight;
};

/// Prior of one base parameter. sigma > 0 small: known constant; large: to be found.
struct Prior {
  double mean{};
  double sigma{};
};

/// Degrees of freedom in the order X Y Z K M N.
constexpr std::array<const char*, 6> kAxisNames{"X", "Y", "Z", "K", "M", "N"};
constexpr std::array<const char*, 6> kVelocityNames{"u", "v", "w", "p", "q", "r"};

struct Vehicle {
  std::string name;
  std::array<bool, 6> dof{};                         ///< simulated degrees of freedom; the others enter as measured
  double mass{};                                     ///< kg, rigid body (dry); 0 when unknown
  Eigen::Vector3d inertia{Eigen::Vector3d::Zero()};  ///< kg m^2, rigid body diagonal; 0 when unknown
  double buoyancy{};                                 ///< N; 0 when unknown
  double water_density{};                            ///< kg/m^3
  double nominal_voltage{};                          ///< V; 0 when unknown
  double largest_thrust{};                           ///< N, of one thruster, either way; 0 when not stated
  Eigen::Vector3d hull{Eigen::Vector3d::Zero()};     ///< m, length, width, height about Bo; 0 when unknown
  double windage{};                                  ///< m^2, side view of what stands above the water; 0: nothing does
  std::vector<Thruster> thrusters;
  ThrustCurve curve;
  std::vector<std::string>
      parameters;             ///< base parameters that this vehicle enables, e.g. "m_X", "X_u", "X_u|u|", "W-B", "G_z"
  std::vector<Prior> priors;  ///< one per parameter
  Eigen::Matrix<double, 6, Eigen::Dynamic> allocation;  ///< tau = allocation * force; 6 x N
  Mounts mounts{};                                      ///< where the instruments sit

  std::optional<Hydrodynamics> hydrodynamics;  ///< for manoeuvres and regression
  std::vector<Candidate> candidates{};         ///< measured columns that a force may go with

  bool flow_matters{false};  ///< some actuator's force depends on the water's speed past it
  bool weight_moves{false};  ///< some actuator's wrench is that of a weight: it depends on the attitude

  /// False for a vehicle that is driven by a body wrench (no thrusters in its file).
  [[nodiscard]] bool has_thrusters() const { return !thrusters.empty(); }

  /// Reads a vehicle file; InputError with file and line when anything is missing, unknown or in a wrong unit.
  [[nodiscard]] static Vehicle load(const std::string& path);
};

}  // namespace fathom::model

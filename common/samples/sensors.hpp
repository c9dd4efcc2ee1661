// What sensors say, in SI units and radians, in the frames of docs/conventions.md. One struct per message type.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace fathom {

/// Motion capture: pose of the body in the world.
struct PoseCapture {
  Utime utime{};
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};            ///< m, NED
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};  ///< unit
  bool valid{true};                                         ///< false where capture was lost, frozen or jumped
  bool has_position{true};                                  ///< false: attitude only
  bool has_attitude{true};                                  ///< false: position only
};

/// Rate gyro and, where `has_*` says so, specific force and attitude (AHRS).
struct Ahrs {
  Utime utime{};
  Eigen::Vector3d w_WB_B{Eigen::Vector3d::Zero()};          ///< rad/s, body rates p q r
  Eigen::Vector3d f_B{Eigen::Vector3d::Zero()};             ///< m/s^2, specific force (at rest: 0 0 -g)
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};  ///< unit
  bool has_rates{false};
  bool has_specific_force{false};
  bool has_attitude{false};
};

/// Doppler velocity log, already in body axes and at the body origin.
struct Dvl {
  Utime utime{};
  Eigen::Vector3d v_WB_B{Eigen::Vector3d::Zero()};  ///< m/s over ground
  double altitude{};                                ///< m above bottom; 0 when not measured
  bool valid{true};
  bool held{false};  ///< true when the value repeats the one before (sample and hold)
};

/// Pressure depth.
struct Depth {
  Utime utime{};
  double z{};  ///< m, NED, positive down, of the body origin
};

/// What the thrusters were told and, as far as known, what they gave. Order: as in the vehicle file.
struct Thrusters {
  Utime utime{};
  std::vector<double> pwm_us;   ///< us, as commanded; empty when not logged
  std::vector<double> force;    ///< N, along each thruster's axis; empty when not known
  std::array<double, 6> tau{};  ///< N, N m: wrench at the body origin, body axes
  bool has_tau{false};
};

/// Battery under load.
struct Battery {
  Utime utime{};
  double voltage{};  ///< V
};

/// Acoustic position fix, lever arms removed.
struct Usbl {
  Utime utime{};
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};   ///< m, NED
  Eigen::Vector3d sigma{Eigen::Vector3d::Zero()};  ///< m, std of p_WB
  bool valid{true};
};

/// Single-beam echo sounders. Order: as in the vehicle file.
struct Ranges {
  Utime utime{};
  std::vector<double> range;        ///< m along each beam's axis; 0 when not valid
  std::vector<std::uint8_t> valid;  ///< 1: an echo was found
};

/// Load cells. Order: as in the vehicle file.
struct Loads {
  Utime utime{};
  std::vector<double> load;  ///< N, tension along each cell's axis
};

/// One value of a measured column that is none of the above: wind, temperature, a winch's speed.
struct Signal {
  Utime utime{};
  std::string name;      ///< the column's, as in the map
  std::string quantity;  ///< wind_speed_true and the like (lcmtypes/signal_t.lcm); empty where the map does not say
  std::string unit;      ///< SI, rad; else as the map has it
  double value{};        ///< unit
};

}  // namespace fathom

// Where the instruments of a vehicle sit: what the vehicle file says under `sensors`. Estimator and simulator read the
// same numbers; noise and latency are no part of it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/model/lens.hpp"

namespace fathom {
class Config;
}

namespace fathom::model {

/// Place of an instrument S and its axes: forward, right, down of its own; of a camera x right, y down, z out.
struct Mount {
  Eigen::Vector3d p_BS{Eigen::Vector3d::Zero()};  ///< m
  Eigen::Matrix3d R_BS{Eigen::Matrix3d::Identity()};
};

struct DvlMount {
  Mount mount;
  double beam_angle{};  ///< rad, of the four beams to the instrument's down axis
};

/// A camera. The simulator's measurements take it to be without distortion, its axis through the picture's middle.
struct CameraMount {
  std::string name;
  Mount mount;
  int width{};     ///< px
  int height{};    ///< px
  double focal{};  ///< px, mean of both directions
  Lens lens{};     ///< all that is known of it
};

/// A laser that draws a dot into the picture of a camera.
struct LaserMount {
  std::string camera;
  Eigen::Vector3d p_CE{Eigen::Vector3d::Zero()};     ///< m, emitter in C
  Eigen::Vector3d axis_C{Eigen::Vector3d::UnitZ()};  ///< unit, direction of the beam in C
};

/// A load cell between the vehicle and what pulls at it.
struct LoadCellMount {
  std::string name;
  Eigen::Vector3d axis_B{Eigen::Vector3d::UnitX()};  ///< unit; the cell shows the pull along it
  std::string of;                                    ///< "tether", or the name of a thruster
};

/// One accelerometer or gyro that stands beside the inertial package, told as a column of the recording (SIGNAL).
struct SingleInertialMount {
  enum class Measures { kForce, kRate };
  Measures measures{Measures::kForce};
  std::string signal;                                ///< the column's name
  Eigen::Vector3d p_BS{Eigen::Vector3d::Zero()};     ///< m; where a gyro sits does not matter
  Eigen::Vector3d axis_B{Eigen::Vector3d::UnitX()};  ///< unit: its direction cosines
  /// SI, of what it tells.
  [[nodiscard]] const char* unit() const { return measures == Measures::kForce ? "m/s^2" : "rad/s"; }
};

/// Nothing, or an empty list: the vehicle does not carry the instrument.
struct Mounts {
  std::optional<Mount> ahrs, usbl, depth, ranges;  ///< usbl and ranges: the transducer on the vehicle
  std::optional<DvlMount> dvl;
  std::vector<CameraMount> cameras;
  std::optional<LaserMount> laser;
  std::vector<LoadCellMount> loads;          ///< order of LOADS
  std::vector<SingleInertialMount> singles;  ///< `accelerometers` and then `gyros`

  /// The section `sensors` of a vehicle file.
  [[nodiscard]] static Mounts from(const Config& config);
  /// The camera of that name, or nullptr.
  [[nodiscard]] const CameraMount* camera(const std::string& name) const;
};

}  // namespace fathom::model

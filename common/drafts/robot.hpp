// What SDF and URDF have in common: links with masses, joints, and which joints turn propellers.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "common/drafts/draft.hpp"

namespace fathom::drafts {

/// All in the axes M of the model: forward, left, up.
struct Link {
  std::string name;
  Eigen::Isometry3d X_ML{Eigen::Isometry3d::Identity()};  ///< of the link in the model
  double mass{};                                          ///< kg; 0: not stated
  Eigen::Vector3d com_M{Eigen::Vector3d::Zero()};         ///< m, centre of mass
  Eigen::Matrix3d inertia_M{Eigen::Matrix3d::Zero()};     ///< kg m^2, about that
};

struct Joint {
  std::string name, type, parent, child;
  Eigen::Vector3d axis_M{Eigen::Vector3d::UnitX()};  ///< unit
};

/// A plugin that makes thrust along a joint.
struct Propeller {
  std::string joint;
  std::optional<int> number;
  std::optional<double> largest;  ///< N
};

struct Robot {
  std::string name;
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::vector<Propeller> propellers;
  std::optional<double> water_density;  ///< kg/m^3
  std::vector<std::string> remarks;     ///< what of the file was not read
  [[nodiscard]] const Link* link(const std::string& name) const;
};

/// Masses of all links as one rigid body, about whose centre of mass the thrusters are placed. `source` heads the file.
[[nodiscard]] Draft draft_of(const Robot& robot, const std::string& source);

/// SDF of Gazebo; InputError with file and line.
[[nodiscard]] Robot read_sdf(const std::string& path);
/// URDF, with the plugins of Gazebo in it; xacro is to be run before.
[[nodiscard]] Robot read_urdf(const std::string& path);

}  // namespace fathom::drafts

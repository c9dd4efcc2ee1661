// A vehicle file to begin with, from what a drawing or an autopilot's frame says of a vehicle.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace fathom::drafts {

struct DraftThruster {
  std::string name;
  std::optional<Eigen::Vector3d> p_BJ;               ///< m; nothing: to be measured
  Eigen::Vector3d axis_B{Eigen::Vector3d::UnitX()};  ///< unit, direction of positive force
  std::string note;                                  ///< behind it, for whoever reads the file
};

/// Axes forward, right, down.
struct Draft {
  std::string name;
  std::vector<std::string> remarks;        ///< heads the file: where its numbers come from, what is missing
  std::optional<double> mass;              ///< kg; nothing: to be weighed
  std::optional<Eigen::Vector3d> inertia;  ///< kg m^2, diagonal about the centre of mass
  std::optional<double> water_density;     ///< kg/m^3; nothing: fresh water is taken, and said
  std::optional<double> largest_thrust;    ///< N, of every thruster
  std::vector<DraftThruster> thrusters;    ///< none: driven by a wrench
  std::string tail;                        ///< comment lines at the end
};

/// The text of the file. What is not known stands there as MEASURE, which nothing reads as a number.
[[nodiscard]] std::string vehicle_file(const Draft& draft);

}  // namespace fathom::drafts

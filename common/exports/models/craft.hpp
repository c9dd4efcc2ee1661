// An identified model as other simulators take it: a rigid body, the water's share of its inertia, drag, weight and
// buoyancy; in Fathom's own axes, from which each format is written.
#pragma once

#include <string>
#include <vector>

#include "common/model/vehicle.hpp"
#include "common/result/stored.hpp"

namespace fathom::exports {

/// Forward-right-down, about Bo, where the centre of mass sits (the base model has none elsewhere). SI.
struct Craft {
  std::string name;
  double mass{};                                     ///< kg, rigid
  Eigen::Vector3d inertia{Eigen::Vector3d::Zero()};  ///< kg m^2, rigid, diagonal
  Vector6d added{Vector6d::Zero()};                  ///< kg, kg m^2: -X_udot .. -N_rdot, so that mass + added = m_X
  Vector6d linear{Vector6d::Zero()};                 ///< X_u .. N_r, negative where they dissipate
  Vector6d quadratic{Vector6d::Zero()};              ///< X_u|u| .. N_r|r|
  double density{};                                  ///< kg/m^3
  double weight{}, buoyancy{};                       ///< N
  Eigen::Vector3d p_BB{Eigen::Vector3d::Zero()};     ///< m, centre of buoyancy
  std::vector<model::Thruster> thrusters;
  std::vector<std::string> notes;  ///< what was assumed, and what no number of this struct can say
  [[nodiscard]] double volume() const { return buoyancy / (density * kGravity); }
  static constexpr double kGravity = 9.81;  ///< m/s^2, as in the vehicle files
};

/// `vehicle`: of the diagnosis. InputError where the result withholds its numbers or an axis has no inertia.
[[nodiscard]] Craft craft_of(const result::Stored& stored, const model::Vehicle& vehicle);

}  // namespace fathom::exports

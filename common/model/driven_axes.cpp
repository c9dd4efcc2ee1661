#include "common/model/driven_axes.hpp"

#include <array>
#include <vector>

#include "common/base/least_squares.hpp"
#include "common/base/motions.hpp"

namespace fathom::model {
namespace {

constexpr double kReached = 1e-6;  // of a unit wrench, in the units of the allocation

}  // namespace

std::array<bool, 6> driven_axes(const Vehicle& vehicle) {
  if (!vehicle.has_thrusters()) return vehicle.dof;
  std::array<bool, 6> driven{};
  std::vector<Eigen::Index> enabled;
  for (std::size_t i = 0; i < 6; ++i) {
    if (vehicle.dof[i]) enabled.push_back(static_cast<Eigen::Index>(i));
  }
  // Driven: the unit wrench lies in the range of the enabled rows.
  const Eigen::MatrixXd rows = vehicle.allocation(enabled, Eigen::all);
  const Eigen::MatrixXd basis = range_basis(rows);
  for (std::size_t i = 0; i < enabled.size(); ++i) {
    const Eigen::VectorXd wanted = Eigen::VectorXd::Unit(rows.rows(), static_cast<Eigen::Index>(i));
    driven[static_cast<std::size_t>(enabled[i])] = (basis * (basis.transpose() * wanted) - wanted).norm() <= kReached;
  }
  return driven;
}

bool pushed_along(const Vehicle& vehicle, Eigen::Index axis) {
  constexpr double kNoThrust = 1e-9;  // of the allocation, 1 or m
  return !vehicle.has_thrusters() || !vehicle.allocation.row(axis).isZero(kNoThrust);
}

std::string undriven_note(const Vehicle& vehicle) {
  const std::array<bool, 6> driven = driven_axes(vehicle);
  std::string axes;
  int count = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    if (vehicle.dof[i] && !driven[i]) axes += (count++ == 0 ? "" : ", ") + std::string(kMotionNames[i]);
  }
  if (count == 0) return {};
  return vehicle.name + ": " + axes + (count == 1 ? " moves" : " move") + " freely, without thrust of " +
         (count == 1 ? "its" : "their") + " own (if the thrusters do drive " + (count == 1 ? "it" : "them") +
         ", correct their geometry)";
}

}  // namespace fathom::model

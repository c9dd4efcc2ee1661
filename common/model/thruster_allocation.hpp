// Wrench to thrusters, for any geometry: which forces give it, and which pulse widths give the forces.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

/// What is sent and what it gives.
struct Allocated {
  std::vector<double> pwm_us{};    ///< us, order of the vehicle file; empty when it has no thrust curve
  std::vector<double> force{};     ///< N, along each thruster's axis
  Vector6d tau{Vector6d::Zero()};  ///< what these forces give
  double scale{1.0};              ///< < 1: a thruster was at its limit and all were scaled, so that the direction stays
  std::array<bool, 6> missing{};  ///< axes of the wrench that were asked for and that no force of the thrusters gives
};

class ThrusterAllocation {
 public:
  /// `largest` [N]: no thruster is asked for more. InputError when the vehicle has no thrusters, or when they cannot
  /// produce one of its free motions by itself.
  ThrusterAllocation(const Vehicle& vehicle, double largest);

  /// Smallest forces that give the wrench in the vehicle's degrees of freedom. `battery` [V]; 0: as the curve was
  /// measured. Without a thrust curve the forces themselves are what is sent.
  [[nodiscard]] Allocated allocate(const Vector6d& tau, double battery) const;
  [[nodiscard]] Allocated neutral() const;
  /// What pulse widths that a vehicle reports give.
  [[nodiscard]] Allocated applied(const std::vector<double>& pwm_us, double battery) const;
  /// What forces [N] that a vehicle reports give.
  [[nodiscard]] Allocated applied_forces(const std::vector<double>& force) const;
  [[nodiscard]] std::size_t count() const { return vehicle_.thrusters.size(); }
  /// One line for the operator about Allocated::missing; empty when nothing is.
  [[nodiscard]] std::string complaint(const Allocated& allocated) const;

 private:
  [[nodiscard]] double pwm_of(double force, double sign, double battery) const;
  [[nodiscard]] double voltage_factor(double battery) const;

  Vehicle vehicle_;
  double largest_;
  Eigen::Matrix<double, Eigen::Dynamic, 6> inverse_;  ///< forces = inverse * tau
};

}  // namespace fathom::model

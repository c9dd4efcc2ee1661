// Wrench to thrusters: which forces give it, and which pulse widths give the forces.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::driver {

/// What is sent and what it gives.
struct Allocated {
  std::vector<double> pwm_us;      ///< us, order of the vehicle file
  std::vector<double> force;       ///< N, along each thruster's axis
  Vector6d tau{Vector6d::Zero()};  ///< what these forces give
  double scale{1.0};  ///< < 1: a thruster was at its limit and all were scaled, so that the direction stays
};

class Allocation {
 public:
  /// `largest` [N]: no thruster is asked for more. InputError when the vehicle has no thrusters or no curve.
  Allocation(const model::Vehicle& vehicle, double largest);

  /// Smallest forces that give the wrench in the vehicle's degrees of freedom. `battery` [V]; 0: as the curve was
  /// measured.
  [[nodiscard]] Allocated allocate(const Vector6d& tau, double battery) const;
  [[nodiscard]] Allocated neutral() const;
  /// What pulse widths that a vehicle reports give.
  [[nodiscard]] Allocated applied(const std::vector<double>& pwm_us, double battery) const;
  [[nodiscard]] std::size_t count() const { return vehicle_.thrusters.size(); }

 private:
  [[nodiscard]] double pwm_of(double force, double sign, double battery) const;
  [[nodiscard]] double voltage_factor(double battery) const;

  model::Vehicle vehicle_;
  double largest_;
  Eigen::Matrix<double, Eigen::Dynamic, 6> inverse_;  ///< forces = inverse * tau
};

}  // namespace fathom::driver

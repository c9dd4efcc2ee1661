// Thrusters of two kinds, which often are two makes on two drivers: those that push up and down, and the others.
#pragma once

#include <cmath>
#include <cstdlib>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

/// Force straight up or down, or a pure roll or pitch moment: the jet leaves vertically.
[[nodiscard]] inline bool is_vertical(const Vehicle& vehicle, Eigen::Index actuator, Eigen::Index actuators) {
  const bool wrench = vehicle.allocation.cols() != actuators;
  if (wrench) return actuator == 2 || actuator == 3 || actuator == 4;
  const auto column = vehicle.allocation.col(actuator);
  return std::abs(column[2]) > column.head<2>().norm();
}

/// A rudder, a fin or a weight, which no battery, propeller or reversal concerns.
[[nodiscard]] inline bool is_no_propeller(const Motion& motion, Eigen::Index actuator) {
  if (motion.vehicle == nullptr || !(motion.vehicle->flow_matters || motion.vehicle->weight_moves)) return false;
  const auto& thrusters = motion.vehicle->thrusters;
  if (static_cast<std::size_t>(motion.force.size()) != thrusters.size()) return false;
  const Thruster& one = thrusters[static_cast<std::size_t>(actuator)];
  return one.fin.has_value() || one.weight.has_value();
}

/// Whether a data set has both.
[[nodiscard]] inline bool has_both_kinds(const Scene& scene) {
  const Eigen::Index actuators = scene.force_rms.size();
  Eigen::Index vertical = 0;
  for (Eigen::Index i = 0; i < actuators; ++i) vertical += is_vertical(*scene.vehicle, i, actuators) ? 1 : 0;
  return vertical > 0 && vertical < actuators;
}

/// s: of the vertical ones where the others have `time` and these are `later` by some. No time is less than nothing;
/// it comes there smoothly, so that a fit that ends there still knows how surely. Exactly `time` where none are later.
[[nodiscard]] inline double time_of_vertical(double time, double later) {
  constexpr double kNothing = 0.01;  // s
  const double sum = time + later;
  return later == 0.0 || sum > kNothing ? sum : kNothing * std::exp(sum / kNothing - 1.0);
}

}  // namespace fathom::model

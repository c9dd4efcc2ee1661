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

/// A rudder, a fin or a weight is none: no battery, propeller or reversal concerns it.
[[nodiscard]] inline bool is_propeller(const Thruster& one) { return !one.fin && !one.weight; }

/// Whether the motion's forces are those of the vehicle's actuators, one each; else they are a wrench, or not its.
[[nodiscard]] inline bool by_thruster(const Motion& motion) {
  return motion.vehicle != nullptr && motion.vehicle->thrusters.size() == static_cast<std::size_t>(motion.force.size());
}

/// Of a motion's actuator, where it is one.
[[nodiscard]] inline bool is_no_propeller(const Motion& motion, Eigen::Index actuator) {
  if (motion.vehicle == nullptr || !(motion.vehicle->flow_matters || motion.vehicle->weight_moves)) return false;
  return by_thruster(motion) && !is_propeller(motion.vehicle->thrusters[static_cast<std::size_t>(actuator)]);
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

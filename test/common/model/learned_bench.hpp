// A learned force on a vehicle's file, for tests.
#pragma once

#include <algorithm>
#include <initializer_list>

#include "common/model/learned/learned_force.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::test {

using namespace model;

inline FreeForce one(const Feature& feature, double weight) {
  return {.features = {feature}, .groups = {{.kind = "test", .axis = feature.axis, .count = 1}}, .weights = {weight}};
}

inline Feature along(int axis, std::initializer_list<Factor> factors, double scale = 1.0) {
  Feature feature{.axis = axis, .count = static_cast<int>(factors.size()), .scale = scale};
  std::ranges::copy(factors, feature.factors.begin());
  return feature;
}

const Factor kU{.quantity = Quantity::kVelocity, .index = 0}, kV{.quantity = Quantity::kVelocity, .index = 1};

struct Bench {
  Vehicle vehicle = vehicle_from_repository("bluerov2");
  Visited visited{
      .nu = Vector6d::Constant(0.5), .tau = Vector6d::Constant(20.0), .force = ActuatorForces::Constant(6, 10.0)};

  Vector6d wrench(const LearnedForce& force, const Vector6d& nu, const Vector6d& drag = Vector6d::Zero()) const {
    Motion motion{.nu = nu, .force = ActuatorForces::Zero(6)};
    Load load;
    load.clear();
    load.drag = drag;
    force.load(motion, {}, 0, load);
    return load.wrench;
  }
  LearnedForce made(const FreeForce& force) const { return {force, visited, vehicle.allocation}; }
};

}  // namespace fathom::test
